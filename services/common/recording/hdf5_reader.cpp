#include "services/common/recording/hdf5_reader.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>
#include <numeric>

#include "sealwatch/core/file.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kLongestName = 1000;
constexpr std::size_t kMostObjects = 10'000;

/// An identifier of HDF5, closed at its end.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

bool is_number(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

/// The length of a data set that is a vector; 0 where it is none.
std::size_t vector_length(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), &H5Sclose);
  if (!space || H5Sget_simple_extent_type(space.get()) != H5S_SIMPLE) return 0;
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > H5S_MAX_RANK) return 0;
  std::array<hsize_t, H5S_MAX_RANK> sizes{};
  H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr);
  const auto begin = sizes.begin(), end = sizes.begin() + rank;
  const hsize_t longest = *std::max_element(begin, end);
  const auto others = std::count_if(begin, end, [](hsize_t size) { return size != 1; });
  return others <= 1 ? static_cast<std::size_t>(longest) : 0;
}

/// Whether the data of a data set is that of another file, which may be any on this machine, a pipe among them.
bool lies_elsewhere(hid_t dataset) {
  const Handle made(H5Dget_create_plist(dataset), &H5Pclose);
  return !made || H5Pget_layout(made.get()) == H5D_VIRTUAL || H5Pget_external_count(made.get()) > 0;
}

std::string text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), &H5Aclose);
  const Handle type(H5Aget_type(attribute.get()), &H5Tclose);
  if (!attribute || !type || H5Tget_class(type.get()) != H5T_STRING) return {};
  const Handle space(H5Aget_space(attribute.get()), &H5Sclose);
  if (!space || H5Sget_simple_extent_npoints(space.get()) != 1) return {};
  if (H5Tis_variable_str(type.get()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute.get(), type.get(), static_cast<void*>(&text)) < 0 || text == nullptr) return {};
    std::string out(text, strnlen(text, kLongestName));
    H5free_memory(text);
    return out;
  }
  std::string out(std::min(H5Tget_size(type.get()), kLongestName), '\0');
  if (H5Tget_size(type.get()) > kLongestName || H5Aread(attribute.get(), type.get(), out.data()) < 0) return {};
  return out.substr(0, out.find('\0'));
}

class Reader {
 public:
  explicit Reader(std::vector<MatVariable>& found) : found_(found) {}

  Status status = {};

  void count(const char* name) {
    if (std::strlen(name) > kLongestName)
      status = fail(error_at({}, {}, "its groups are nested too deeply", "put the data sets into few groups"));
    else if (++objects_ > kMostObjects)
      status = fail(error_at({}, {}, "the file holds more than " + std::to_string(kMostObjects) + " objects",
                             "one recording is one test: split the file"));
  }

  void dataset(hid_t file, const char* name) {
    const Handle data(H5Dopen2(file, name, H5P_DEFAULT), &H5Dclose);
    if (!data) return;
    if (lies_elsewhere(data.get())) {
      status = fail(error_at("data set " + printable(name), {}, "its data lies in another file, which is not followed",
                             "copy the data into this one"));
      return;
    }
    const Handle type(H5Dget_type(data.get()), &H5Tclose);
    const std::size_t length = vector_length(data.get());
    if (!type || length == 0) return;
    std::string unit = text_attribute(data.get(), "unit");
    if (unit.empty()) unit = text_attribute(data.get(), "units");
    if (is_number(type.get()))
      read(data.get(), H5T_NATIVE_DOUBLE, length, name, unit);
    else if (H5Tget_class(type.get()) == H5T_COMPOUND)
      table(data.get(), type.get(), length, name);
  }

 private:
  void table(hid_t data, hid_t type, std::size_t length, const std::string& name) {
    const int count = H5Tget_nmembers(type);
    for (int member = 0; member < count && status; ++member) {
      const Handle kind(H5Tget_member_type(type, static_cast<unsigned>(member)), &H5Tclose);
      char* const text = H5Tget_member_name(type, static_cast<unsigned>(member));
      if (text == nullptr) continue;
      const std::string column(text, strnlen(text, kLongestName));
      H5free_memory(text);
      if (!kind || !is_number(kind.get())) continue;
      const Handle one(H5Tcreate(H5T_COMPOUND, sizeof(double)), &H5Tclose);
      H5Tinsert(one.get(), column.c_str(), 0, H5T_NATIVE_DOUBLE);
      read(data, one.get(), length, name + "/" + column, {});
    }
  }

  void read(hid_t data, hid_t memory_type, std::size_t length, const std::string& name, const std::string& unit) {
    total_ += length;
    if (total_ > kMostNumbers) {
      status = fail(error_at("data set " + printable(name), {},
                             "the file holds more than " + std::to_string(kMostNumbers) + " numbers",
                             "one recording is one test: split the file"));
      return;
    }
    std::vector<double> values(length);
    if (H5Dread(data, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      status =
          fail(error_at("data set " + printable(name), {}, "its data cannot be read: the file is cut off or damaged"));
    else
      found_.push_back({name, std::move(values), unit});
  }

  std::vector<MatVariable>& found_;
  std::size_t total_ = 0;
  std::size_t objects_ = 0;
};

herr_t visit(hid_t file, const char* name, const H5O_info_t* info, void* reader) {
  auto& target = *static_cast<Reader*>(reader);
  target.count(name);
  if (target.status && info->type == H5O_TYPE_DATASET) target.dataset(file, name);
  return target.status ? 0 : 1;
}

Result<std::vector<MatVariable>> read_all(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what went wrong is returned, not printed
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), &H5Fclose);
  if (!file) return fail("is not an HDF5 file, or it is damaged");
  std::vector<MatVariable> found;
  Reader reader(found);
  if (H5Ovisit1(file.get(), H5_INDEX_NAME, H5_ITER_INC, &visit, &reader) < 0 && reader.status)
    return fail("is damaged: its contents cannot be listed");
  if (!reader.status) return fail(reader.status.error());
  return found;
}

}  // namespace

Result<std::vector<MatVariable>> read_hdf5_vectors(const std::string& path) {
  if (const Status is_file = check_file(path, kLargestRecording_bytes); !is_file) return fail(is_file.error());
  static std::mutex one_at_a_time;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  return in_child([&path] { return read_all(path); });
}

}  // namespace sealwatch
