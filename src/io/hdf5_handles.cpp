#include "io/hdf5_handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "io/bytes.h"

namespace meniscus::io {
namespace {

bool is_numeric(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_FLOAT || kind == H5T_INTEGER;
}

std::optional<double> number_in(hid_t attribute) {
  if (attribute < 0) return std::nullopt;
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
  if (!type || !is_numeric(type.get()) || !space || H5Sget_simple_extent_npoints(space.get()) != 1) return std::nullopt;
  double value = 0;
  if (H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0) return std::nullopt;
  return value;
}

}  // namespace

Hdf5Group Hdf5Group::open_file(const std::string& path) {
  std::error_code ignored;
  const std::uint64_t size = std::filesystem::file_size(path, ignored);
  Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) {
    throw Error(ErrorCode::malformed_file, {"is no whole HDF5 file, or another program is writing it",
                                            {},
                                            fmt::format("{} bytes", size),
                                            path,
                                            {},
                                            {},
                                            "wait until it is written, or write the frame again"});
  }
  return {std::move(file), path, size};
}

std::optional<Hdf5Group> Hdf5Group::group(const std::string& name) const {
  if (H5Lexists(handle_.get(), name.c_str(), H5P_DEFAULT) <= 0) return std::nullopt;
  Hdf5Handle group(H5Gopen2(handle_.get(), name.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group) return std::nullopt;
  return Hdf5Group{std::move(group), path_, file_size_};
}

std::vector<std::string> Hdf5Group::names() const {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Literate(handle_.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names);
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<Hdf5Handle> Hdf5Group::numeric_array(const std::string& name) const {
  if (H5Lexists(handle_.get(), name.c_str(), H5P_DEFAULT) <= 0) return std::nullopt;
  Hdf5Handle dataset(H5Dopen2(handle_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset) return std::nullopt;
  const Hdf5Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const Hdf5Handle space(H5Dget_space(dataset.get()), H5Sclose);
  if (!type || !is_numeric(type.get()) || !space) return std::nullopt;
  if (H5Sget_simple_extent_ndims(space.get()) != 1) return std::nullopt;
  return dataset;
}

std::optional<std::uint64_t> Hdf5Group::length_of(const std::string& name) const {
  const std::optional<Hdf5Handle> dataset = numeric_array(name);
  if (!dataset) return std::nullopt;
  const Hdf5Handle space(H5Dget_space(dataset->get()), H5Sclose);
  const hssize_t points = H5Sget_simple_extent_npoints(space.get());
  if (points < 0) return std::nullopt;
  return static_cast<std::uint64_t>(points);
}

/// An array may claim any length: it must be in the file, or, compressed in chunks, be worth what is in the file.
void Hdf5Group::check_size(hid_t dataset, const std::string& name) const {
  constexpr std::uint64_t kMostDeflate = 1100;  // zlib packs at most 1032 to 1
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  const Hdf5Handle plan(H5Dget_create_plist(dataset), H5Pclose);
  const std::uint64_t item = H5Tget_size(type.get());
  const auto count = static_cast<std::uint64_t>(H5Sget_simple_extent_npoints(space.get()));
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(dataset), file_size_);
  std::uint64_t most = stored;
  hsize_t chunk = 0;
  if (H5Pget_layout(plan.get()) == H5D_CHUNKED) {
    most = std::min(kMostDeflate * stored, believable_size(file_size_));
    if (H5Pget_chunk(plan.get(), 1, &chunk) != 1) chunk = 0;
  }
  if (item > 0 && count <= most / item && (count == 0 || chunk <= std::max(most, file_size_) / item)) return;
  throw Error(ErrorCode::malformed_file, {fmt::format("the array '{}' is longer than what is stored of it", name),
                                          fmt::format("{} x {} bytes", count, item),
                                          fmt::format("{} bytes", stored),
                                          path_,
                                          {},
                                          {},
                                          {}});
}

std::vector<float> Hdf5Group::read(const std::string& name) const {
  const std::optional<Hdf5Handle> dataset = numeric_array(name);
  if (!dataset) {
    throw Error(ErrorCode::malformed_file,
                {fmt::format("has no array '{}' of numbers", name), {}, {}, path_, {}, {}, {}});
  }
  check_size(dataset->get(), name);
  std::vector<float> values(static_cast<std::size_t>(length_of(name).value_or(0)));
  if (!values.empty() && H5Dread(dataset->get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw Error(ErrorCode::malformed_file,
                {fmt::format("the array '{}' is damaged", name), {}, {}, path_, {}, {}, "write the frame again"});
  }
  return values;
}

std::optional<double> Hdf5Group::number(const std::string& name) const {
  if (H5Aexists(handle_.get(), name.c_str()) > 0) {
    const Hdf5Handle attribute(H5Aopen(handle_.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
    return number_in(attribute.get());
  }
  if (H5Lexists(handle_.get(), name.c_str(), H5P_DEFAULT) <= 0) return std::nullopt;
  const Hdf5Handle dataset(H5Dopen2(handle_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset) return std::nullopt;
  const Hdf5Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const Hdf5Handle space(H5Dget_space(dataset.get()), H5Sclose);
  if (!type || !is_numeric(type.get()) || !space || H5Sget_simple_extent_npoints(space.get()) != 1) return std::nullopt;
  double value = 0;
  if (H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0) return std::nullopt;
  return value;
}

std::optional<double> Hdf5Group::number_of(const std::string& array, const std::string& name) const {
  if (H5Aexists_by_name(handle_.get(), array.c_str(), name.c_str(), H5P_DEFAULT) <= 0) return std::nullopt;
  const Hdf5Handle attribute(H5Aopen_by_name(handle_.get(), array.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  return number_in(attribute.get());
}

}  // namespace meniscus::io
