/// What is read of an HDF5 file, over the C library: handles that close themselves, names, checked arrays.
#pragma once

#include <hdf5.h>

#include "io/bytes.h"
#include "io/number_arrays.h"

namespace meniscus::io {

/// An HDF5 identifier and the function that closes it; negative where opening failed.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, hid_t{-1})), close_(other.close_) {}
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

/// Keeps the library from printing its errors while it lives; restores what was there before.
class QuietHdf5 {
 public:
  QuietHdf5() {
    // Of what damaged files leave open it would tell at the program's end.
    static const herr_t no_end = H5dont_atexit();
    static_cast<void>(no_end);
    H5Eget_auto2(H5E_DEFAULT, &print_, &argument_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, print_, argument_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* argument_ = nullptr;
};

/// An open file or group, for reading.
class Hdf5Group {
 public:
  /// @throws Error malformed_file: no HDF5 file, or a truncated one
  static Hdf5Group open_file(const std::string& path);

  /// The group inside this one, or none.
  std::optional<Hdf5Group> group(const std::string& name) const;
  /// Names of everything in it, sorted.
  /// @throws Error malformed_file
  std::vector<std::string> names() const;
  /// What an array in it is, without its values; none if there is no array of that name. Links to other files and
  /// arrays whose values stand in other files are told of, but have no type: they are never followed.
  /// @throws Error malformed_file: there is something that cannot be opened
  std::optional<NumberArray> describe(const std::string& name) const;
  /// Lets an array that describe() gave point to its values: to their place in `file`, where they stand there as they
  /// are, one after the other, else to what is returned, into which the library reads them.
  /// @param file  the same file, to be read without the library; null: there is none
  /// @throws Error malformed_file: damaged, or longer than the stored bytes can justify
  Bytes load(NumberArray& array, const FileBytes* file) const;
  /// A number that tells groups apart, the same for every name that a group has.
  std::uint64_t address() const;
  /// A number stored as an attribute of this group or as an array of one value in it.
  std::optional<double> number(const std::string& name) const;
  /// An attribute of one number of the array `array` in this group.
  std::optional<double> number_of(const std::string& array, const std::string& name) const;

 private:
  Hdf5Group(Hdf5Handle handle, std::string path, std::uint64_t file_size)
      : handle_(std::move(handle)), path_(std::move(path)), file_size_(file_size) {}
  void check_size(hid_t dataset, const NumberArray& array) const;
  Hdf5Handle handle_;
  std::string path_;
  std::uint64_t file_size_;
};

}  // namespace meniscus::io
