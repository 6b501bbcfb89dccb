#include "services/common/recording/hdf5_reader.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <mutex>
#include <utility>

#include "sealwatch/core/file.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/recording/hdf5_attributes.hpp"
#include "services/common/recording/mat_container.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kMostObjects = 10'000;
constexpr hsize_t kMostColumns = 256;  // as channels of a test

/// Of a compound or a matrix, as logs name it in their map.
std::string part_of(const std::string& name, const std::string& part) { return name + "/" + part; }

bool is_number(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

/// Samples and columns of a data set of one dimension, or of two: samples are then along the longer.
struct Shape {
  std::size_t samples = 0;  ///< 0: it is no vector and no matrix
  std::size_t columns = 1;
  bool columns_first = false;  ///< all samples of a column stand together
};

Shape shape_of(hid_t dataset) {
  const Hdf5Handle space(H5Dget_space(dataset), &H5Sclose);
  if (!space || H5Sget_simple_extent_type(space.get()) != H5S_SIMPLE) return {};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > H5S_MAX_RANK) return {};
  std::array<hsize_t, H5S_MAX_RANK> sizes{};
  H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr);
  const auto begin = sizes.begin(), end = sizes.begin() + rank;
  const hsize_t longest = *std::max_element(begin, end);
  const auto others = std::count_if(begin, end, [](hsize_t size) { return size != 1; });
  if (others <= 1) return {.samples = static_cast<std::size_t>(longest)};
  if (rank != 2 || std::min(sizes[0], sizes[1]) > kMostColumns || sizes[0] == sizes[1] ||
      std::min(sizes[0], sizes[1]) == 0 || longest > kMostNumbers)
    return {};
  const bool columns_first = sizes[0] < sizes[1];
  return {.samples = static_cast<std::size_t>(longest),
          .columns = static_cast<std::size_t>(std::min(sizes[0], sizes[1])),
          .columns_first = columns_first};
}

/// Whether the data of a data set is that of another file, which may be any on this machine, a pipe among them.
bool lies_elsewhere(hid_t dataset) {
  const Hdf5Handle made(H5Dget_create_plist(dataset), &H5Pclose);
  return !made || H5Pget_layout(made.get()) == H5D_VIRTUAL || H5Pget_external_count(made.get()) > 0;
}

/// The name of a compression that this machine's library does not have; "" where there is none.
std::string unknown_filter(hid_t dataset) {
  const Hdf5Handle made(H5Dget_create_plist(dataset), &H5Pclose);
  const int count = made ? H5Pget_nfilters(made.get()) : 0;
  for (int k = 0; k < count; ++k) {
    std::array<char, 64> name{};
    std::size_t no_values = 0;
    unsigned flags = 0;
    const H5Z_filter_t filter = H5Pget_filter2(made.get(), static_cast<unsigned>(k), &flags, &no_values, nullptr,
                                               name.size() - 1, name.data(), nullptr);
    if (filter > 0 && H5Zfilter_avail(filter) <= 0)
      return name[0] != '\0' ? printable(name.data()) : "filter " + std::to_string(filter);
  }
  return {};
}

class Reader {
 public:
  explicit Reader(std::vector<MatVariable>& found) : found_(found) {}

  Status status = {};

  void count(const char* name) {
    if (std::strlen(name) > kLongestHdf5Name)
      status = fail(error_at({}, {}, "its groups are nested too deeply", "put the data sets into few groups"));
    else if (++objects_ > kMostObjects)
      status = fail(error_at({}, {}, "the file holds more than " + std::to_string(kMostObjects) + " objects",
                             "one recording is one test: split the file"));
  }

  void dataset(hid_t file, const char* name) {
    const Hdf5Handle data(H5Dopen2(file, name, H5P_DEFAULT), &H5Dclose);
    if (!data) return;
    if (lies_elsewhere(data.get())) {
      status = fail(error_at("data set " + printable(name), {}, "its data lies in another file, which is not followed",
                             "copy the data into this one"));
      return;
    }
    const Hdf5Handle type(H5Dget_type(data.get()), &H5Tclose);
    const Shape shape = shape_of(data.get());
    if (!type || shape.samples == 0 || std::strstr(name, "#refs#") != nullptr) return;
    const Hdf5Attributes said = hdf5_attributes(data.get());
    if (const MatVariable unread = why_not(type.get(), said); !unread.rule.empty()) {
      if (shape.samples > 1) found_.push_back(unread), found_.back().name = name;
    } else if (H5Tget_class(type.get()) == H5T_COMPOUND) {
      table(data.get(), type.get(), shape.samples, name, said);
    } else if (is_number(type.get()) && !said.is_matlab_empty) {
      const bool fits = total_ + shape.samples * shape.columns <= kMostNumbers;  // a picture is passed over
      if (shape.columns == 1 || fits) matrix(data.get(), shape, name, said);
    }
  }

 private:
  /// Why no vector is read from a data set that may be taken for a channel's; no rule where one is.
  static MatVariable why_not(hid_t type, const Hdf5Attributes& said) {
    if (H5Tget_class(type) == H5T_STRING || said.matlab_class == "char")
      return {.name = {},
              .values = {},
              .rule = "holds text, where one number for each sample is needed",
              .advice = "store times as numbers, in s from the test's begin"};
    if (said.is_matlab_object)
      return {.name = {},
              .values = {},
              .rule = "is an object of MATLAB's class " + printable(said.matlab_class),
              .advice = "save its vectors alone, of a timeseries Time and Data"};
    if (H5Tget_class(type) == H5T_COMPOUND && H5Tget_nmembers(type) == 2 && H5Tget_member_index(type, "real") >= 0 &&
        H5Tget_member_index(type, "imag") >= 0)
      return {.name = {}, .values = {}, .rule = kIsComplex, .advice = kStoreRealPart};
    return {};
  }

  void table(hid_t data, hid_t type, std::size_t length, const std::string& name, const Hdf5Attributes& said) {
    const auto count = static_cast<std::size_t>(std::max(H5Tget_nmembers(type), 0));
    for (std::size_t member = 0; member < count && status; ++member) {
      const Hdf5Handle kind(H5Tget_member_type(type, static_cast<unsigned>(member)), &H5Tclose);
      char* const text = H5Tget_member_name(type, static_cast<unsigned>(member));
      if (text == nullptr) continue;
      const std::string column(text, strnlen(text, kLongestHdf5Name));
      H5free_memory(text);
      if (!kind || !is_number(kind.get())) continue;
      const Hdf5Handle one(H5Tcreate(H5T_COMPOUND, sizeof(double)), &H5Tclose);
      H5Tinsert(one.get(), column.c_str(), 0, H5T_NATIVE_DOUBLE);
      const std::vector<double> values = read(data, one.get(), length, name);
      if (status) add(part_of(name, column), values, said.units.size() == count ? said.units[member] : "", said);
    }
  }

  /// A matrix is as many vectors as it has columns, NAME/1, NAME/2 or by their names.
  void matrix(hid_t data, const Shape& shape, const std::string& name, const Hdf5Attributes& said) {
    const std::vector<double> all = read(data, H5T_NATIVE_DOUBLE, shape.samples * shape.columns, name);
    for (std::size_t column = 0; column < shape.columns && status; ++column) {
      std::vector<double> values(shape.samples);
      for (std::size_t k = 0; k < shape.samples; ++k)
        values[k] = all[shape.columns_first ? column * shape.samples + k : k * shape.columns + column];
      const std::string last = said.names.size() == shape.columns ? said.names[column] : std::to_string(column + 1);
      std::string unit = said.units.empty() ? "" : said.units.front();
      if (said.units.size() > 1) unit = said.units.size() == shape.columns ? said.units[column] : "";
      add(shape.columns > 1 ? part_of(name, last) : name, std::move(values), unit, said);
    }
  }

  void add(std::string name, std::vector<double> values, std::string unit, const Hdf5Attributes& said) {
    for (double& value : values)
      value = std::ranges::find(said.no_values, value) == said.no_values.end()
                  ? said.scale * value + said.offset
                  : std::numeric_limits<double>::quiet_NaN();
    MatVariable& vector = found_.emplace_back();
    vector.name = std::move(name), vector.values = std::move(values), vector.unit = std::move(unit);
    vector.scaling = said.other_scaling;
  }

  std::vector<double> read(hid_t data, hid_t memory_type, std::size_t length, const std::string& name) {
    total_ += length;
    if (length > kMostNumbers || total_ > kMostNumbers) {
      status = fail(error_at("data set " + printable(name), {},
                             "the file holds more than " + std::to_string(kMostNumbers) + " numbers",
                             "one recording is one test: split the file"));
      return {};
    }
    std::vector<double> values(length);
    if (H5Dread(data, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      const std::string filter = unknown_filter(data);
      status =
          fail(filter.empty() ? error_at("data set " + printable(name), {},
                                         "its data cannot be read: the file is cut off or damaged")
                              : error_at("data set " + printable(name), filter, "is a compression that is not read",
                                         "store it with gzip, or without compression"));
    }
    return values;
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
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), &H5Fclose);
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
