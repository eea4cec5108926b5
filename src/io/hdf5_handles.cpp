#include "io/hdf5_handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "io/file_bytes.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kMostNames = 4096;  ///< of a group that are looked at

bool is_numeric(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_FLOAT || kind == H5T_INTEGER;
}

/// Access that follows no link into another file.
Hdf5Handle within_the_file(hid_t kind) {
  Hdf5Handle access(H5Pcreate(kind), H5Pclose);
  const auto refuse = [](const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) -> herr_t {
    return -1;
  };
  H5Pset_elink_cb(access.get(), refuse, nullptr);
  return access;
}

/// The type and byte order of numbers that stand in the file as they are here; none: the library converts them.
std::optional<std::pair<Scalar, std::endian>> plain_type(hid_t type) {
  const std::array<std::pair<hid_t, hid_t>, 10> known{{{H5T_STD_I8LE, H5T_STD_I8BE},
                                                       {H5T_STD_U8LE, H5T_STD_U8BE},
                                                       {H5T_STD_I16LE, H5T_STD_I16BE},
                                                       {H5T_STD_U16LE, H5T_STD_U16BE},
                                                       {H5T_STD_I32LE, H5T_STD_I32BE},
                                                       {H5T_STD_U32LE, H5T_STD_U32BE},
                                                       {H5T_STD_I64LE, H5T_STD_I64BE},
                                                       {H5T_STD_U64LE, H5T_STD_U64BE},
                                                       {H5T_IEEE_F32LE, H5T_IEEE_F32BE},
                                                       {H5T_IEEE_F64LE, H5T_IEEE_F64BE}}};
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (H5Tequal(type, known[i].first) > 0) return std::pair{static_cast<Scalar>(i), std::endian::little};
    if (H5Tequal(type, known[i].second) > 0) return std::pair{static_cast<Scalar>(i), std::endian::big};
  }
  return std::nullopt;
}

/// How many values there are, or the largest number if they are more.
std::uint64_t product_of(std::span<const std::uint64_t> lengths) {
  constexpr std::uint64_t kMost = ~std::uint64_t{0};
  std::uint64_t product = 1;
  for (const std::uint64_t length : lengths)
    product = length > 0 && product > kMost / length ? kMost : product * length;
  return product;
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

/// Where `size` bytes of an array's values stand in a file, as they are and one after the other; null: they do not.
Stored place_in(hid_t dataset, std::uint64_t size, const FileBytes* file) {
  const Hdf5Handle plan(H5Dget_create_plist(dataset), H5Pclose);
  if (file == nullptr || size == 0 || !plan || H5Pget_layout(plan.get()) != H5D_CONTIGUOUS) return {};
  const haddr_t offset = H5Dget_offset(dataset);
  if (offset == HADDR_UNDEF || H5Dget_storage_size(dataset) != size) return {};
  const std::span<const char> bytes = file->span();
  if (offset > bytes.size() || size > bytes.size() - offset) return {};
  return {bytes.data() + offset, file};
}

Error damaged(const std::string& what, const std::string& path) {
  return {ErrorCode::malformed_file, {what + " is damaged", {}, {}, path, {}, {}, "write the frame again"}};
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
  const Hdf5Handle access = within_the_file(H5P_GROUP_ACCESS);
  if (H5Lexists(handle_.get(), name.c_str(), access.get()) <= 0) return std::nullopt;
  Hdf5Handle group(H5Gopen2(handle_.get(), name.c_str(), access.get()), H5Gclose);
  if (!group) return std::nullopt;
  return Hdf5Group{std::move(group), path_, file_size_};
}

std::vector<std::string> Hdf5Group::names() const {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    auto& found = *static_cast<std::vector<std::string>*>(list);
    found.emplace_back(name);
    return found.size() < kMostNames ? 0 : 1;
  };
  if (H5Literate(handle_.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0)
    throw damaged("the list of what a group holds", path_);
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<NumberArray> Hdf5Group::describe(const std::string& name) const {
  NumberArray array;
  array.name = name;
  const Hdf5Handle access = within_the_file(H5P_DATASET_ACCESS);
  if (H5Lexists(handle_.get(), name.c_str(), access.get()) <= 0) return std::nullopt;
  H5L_info_t link{};
  if (H5Lget_info(handle_.get(), name.c_str(), &link, access.get()) >= 0 && link.type == H5L_TYPE_EXTERNAL) {
    array.type_name = "a link to another file";
    return array;
  }
  // Links by name may lead nowhere; what others lead to is there.
  const Hdf5Handle object(H5Oopen(handle_.get(), name.c_str(), access.get()), H5Oclose);
  if (!object && link.type == H5L_TYPE_HARD) throw damaged(fmt::format("'{}'", name), path_);
  if (!object || H5Iget_type(object.get()) != H5I_DATASET) return std::nullopt;
  const Hdf5Handle dataset(H5Dopen2(handle_.get(), name.c_str(), access.get()), H5Dclose);
  const Hdf5Handle plan(dataset ? H5Dget_create_plist(dataset.get()) : hid_t{-1}, H5Pclose);
  if (!plan) throw damaged(fmt::format("the array '{}'", name), path_);
  if (H5Pget_layout(plan.get()) == H5D_VIRTUAL || H5Pget_external_count(plan.get()) != 0) {
    array.type_name = "values in other files";
    return array;
  }
  const Hdf5Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const Hdf5Handle space(H5Dget_space(dataset.get()), H5Sclose);
  if (!type || !space) throw damaged(fmt::format("the array '{}'", name), path_);
  std::array<hsize_t, H5S_MAX_RANK> lengths{};
  const int rank = H5Sget_simple_extent_dims(space.get(), lengths.data(), nullptr);
  for (int i = 0; i < rank; ++i) array.shape.push_back(lengths[static_cast<std::size_t>(i)]);
  array.type_name = "no numbers";
  if (H5Sget_simple_extent_type(space.get()) == H5S_NULL || !is_numeric(type.get())) return array;
  const auto plain = plain_type(type.get());
  array.type = plain ? plain->first : Scalar::float64;
  array.order = plain ? plain->second : std::endian::native;
  array.type_name = name_of(*array.type);
  return array;
}

/// An array may claim any length: it must be in the file, or, compressed in chunks, be worth what is in the file.
void Hdf5Group::check_size(hid_t dataset, const NumberArray& array) const {
  constexpr std::uint64_t kMostDeflate = 1100;  // zlib packs at most 1032 to 1
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const Hdf5Handle plan(H5Dget_create_plist(dataset), H5Pclose);
  const std::uint64_t item = H5Tget_size(type.get());
  const std::uint64_t count = product_of(array.shape);  // the library's own count may have wrapped around
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(dataset), file_size_);
  std::uint64_t most = stored;
  std::uint64_t chunk = 0;
  if (H5Pget_layout(plan.get()) == H5D_CHUNKED) {
    most = std::min(kMostDeflate * stored, believable_size(file_size_));
    std::array<hsize_t, H5S_MAX_RANK> lengths{};
    const int rank = H5Pget_chunk(plan.get(), H5S_MAX_RANK, lengths.data());
    chunk = product_of(std::vector<std::uint64_t>(lengths.begin(), lengths.begin() + std::max(rank, 0)));
  }
  if (item > 0 && count <= most / item && (count == 0 || chunk <= std::max(most, file_size_) / item)) return;
  throw Error(ErrorCode::malformed_file, {fmt::format("the array '{}' is longer than what is stored of it", array.name),
                                          fmt::format("{} x {} bytes", count, item),
                                          fmt::format("{} bytes", stored),
                                          path_,
                                          {},
                                          {},
                                          {}});
}

Bytes Hdf5Group::load(NumberArray& array, const FileBytes* file) const {
  const Hdf5Handle access = within_the_file(H5P_DATASET_ACCESS);
  const Hdf5Handle dataset(H5Dopen2(handle_.get(), array.name.c_str(), access.get()), H5Dclose);
  if (!dataset || !array.type)
    throw Error(ErrorCode::malformed_file,
                {fmt::format("has no array '{}' of numbers", array.name), {}, {}, path_, {}, {}, {}});
  check_size(dataset.get(), array);
  const Hdf5Handle stored(H5Dget_type(dataset.get()), H5Tclose);
  const std::uint64_t count = product_of(array.shape);
  const std::size_t value = size_of(*array.type);
  array.step = value;
  array.stride = array.columns() * value;
  if (plain_type(stored.get())) {
    array.first = place_in(dataset.get(), count * value, file);
    if (array.first.at != nullptr) return {};
  }
  Bytes bytes(static_cast<std::size_t>(count) * value);
  const hid_t type = plain_type(stored.get()) ? stored.get() : H5T_NATIVE_DOUBLE;
  if (count > 0 && H5Dread(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
    throw damaged(fmt::format("the array '{}'", array.name), path_);
  array.first = bytes.data();
  return bytes;
}

std::uint64_t Hdf5Group::address() const {
  H5O_info_t about{};
  H5Oget_info2(handle_.get(), &about, H5O_INFO_BASIC);
  return about.addr;
}

std::optional<double> Hdf5Group::number(const std::string& name) const {
  if (H5Aexists(handle_.get(), name.c_str()) > 0) {
    const Hdf5Handle attribute(H5Aopen(handle_.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
    return number_in(attribute.get());
  }
  if (H5Lexists(handle_.get(), name.c_str(), H5P_DEFAULT) <= 0) return std::nullopt;
  const Hdf5Handle access = within_the_file(H5P_DATASET_ACCESS);
  const Hdf5Handle dataset(H5Dopen2(handle_.get(), name.c_str(), access.get()), H5Dclose);
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
