#include "services/common/recording/mat_reader.hpp"

#include <hdf5.h>
#include <matio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>

#include "services/common/recording/hdf5_child.hpp"
#include "services/common/recording/hdf5_reader.hpp"
#include "services/common/recording/mat_container.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

const std::string kTooMany = "the file holds more than " + std::to_string(kMostNumbers) + " numbers";

struct Close {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct Free {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, Close>;
using Variable = std::unique_ptr<matvar_t, Free>;

Error variable_error(const std::string& name, std::string rule, std::string advice = {}) {
  return error_at("row 1, column " + printable(name), {}, std::move(rule), std::move(advice));
}

template <class Number>
std::vector<double> to_doubles(const matvar_t& variable, std::size_t count) {
  const auto* const data = static_cast<const Number*>(variable.data);
  std::vector<double> values(count);
  std::transform(data, data + count, values.begin(), [](Number value) { return static_cast<double>(value); });
  return values;
}

/// The `count` numbers of a variable whose data was read; none when it is not of a numeric class.
std::vector<double> numbers(const matvar_t& variable, std::size_t count) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return to_doubles<double>(variable, count);
    case MAT_C_SINGLE:
      return to_doubles<float>(variable, count);
    case MAT_C_INT8:
      return to_doubles<std::int8_t>(variable, count);
    case MAT_C_UINT8:
      return to_doubles<std::uint8_t>(variable, count);
    case MAT_C_INT16:
      return to_doubles<std::int16_t>(variable, count);
    case MAT_C_UINT16:
      return to_doubles<std::uint16_t>(variable, count);
    case MAT_C_INT32:
      return to_doubles<std::int32_t>(variable, count);
    case MAT_C_UINT32:
      return to_doubles<std::uint32_t>(variable, count);
    case MAT_C_INT64:
      return to_doubles<std::int64_t>(variable, count);
    case MAT_C_UINT64:
      return to_doubles<std::uint64_t>(variable, count);
    default:
      return {};
  }
}

Error no_channel(const std::string& name, const Error& why) { return variable_error(name, why.rule, why.advice); }

Result<std::size_t> vector_length(const matvar_t& variable, const std::string& name) {
  const bool numeric = variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64;
  const bool vector = variable.rank == 2 && (variable.dims[0] == 1 || variable.dims[1] == 1);
  if (numeric && variable.isComplex != 0) return fail(variable_error(name, kIsComplex, kTakeOutOrStore));
  if (!numeric || !vector) return fail(variable_error(name, "must be one vector of real numbers", kTakeOutOrStore));
  const std::size_t length = variable.dims[0] * variable.dims[1];
  if (length == 0) return fail(variable_error(name, "holds no samples"));
  if (length > kMostNumbers) return fail(variable_error(name, kTooMany));
  return length;
}

Result<std::vector<double>> read_vector(mat_t* file, matvar_t* variable, const std::string& name, std::size_t length) {
  if (Mat_VarReadDataAll(file, variable) != 0 || variable->data == nullptr ||
      variable->nbytes < length * static_cast<std::size_t>(variable->data_size))
    return fail(variable_error(name, "its data cannot be read: the file is cut off or damaged"));
  return numbers(*variable, length);
}

Result<std::vector<MatVariable>> read_variables(const std::string& path, const PlantDescription& plant) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what went wrong is returned, not printed
  const MatFile file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) return fail("is damaged: neither MATLAB version 5 nor 7.3 can be read from it");
  std::vector<MatVariable> variables;
  std::size_t total = 0;
  while (const Variable variable{Mat_VarReadNextInfo(file.get())}) {
    std::string name = variable->name != nullptr ? variable->name : "";
    const Result<Column> column = find_column(name, plant);
    if (!column) return fail(no_channel(name, column.error()));
    if (!column->known) {
      variables.push_back({std::move(name), {}});
      continue;
    }
    const Result<std::size_t> length = vector_length(*variable, name);
    if (!length) return fail(length.error());
    Result<std::vector<double>> samples = read_vector(file.get(), variable.get(), name, *length);
    if (!samples) return fail(samples.error());
    total += samples->size();
    if (total > kMostNumbers) return fail(variable_error(name, kTooMany));
    variables.push_back({std::move(name), std::move(*samples)});
  }
  return variables;
}

/// All vectors of a file of version 5, those in structs by their path: rec/Y/2/Data is field Data of the second of Y.
class NestedVectors {
 public:
  explicit NestedVectors(mat_t* file) : file_(file) {}

  Status add(matvar_t& variable, const std::string& name, int depth) {
    if (++objects_ > kMostObjects || depth > kDeepest)
      return fail(variable_error(name, "is nested too deeply, or holds too much", "save its vectors alone"));
    if (variable.class_type == MAT_C_STRUCT) return add_fields(variable, name, depth);
    if (variable.isComplex != 0) return pass_over(name, kIsComplex, kStoreRealPart);
    if (variable.class_type == MAT_C_CHAR || variable.class_type == MAT_C_OPAQUE ||
        variable.class_type == MAT_C_OBJECT || variable.class_type == MAT_C_CELL || variable.class_type == MAT_C_SPARSE)
      return pass_over(
          name, "is text, a cell array, a sparse matrix or an object, where one number for each sample is needed",
          "save its vectors alone, of a timeseries Time and Data");
    return add_numbers(variable, name);
  }

  std::vector<MatVariable> take() { return std::move(found_); }

 private:
  Status pass_over(const std::string& name, const char* rule, const char* advice) {
    found_.push_back({.name = name, .values = {}, .rule = rule, .advice = advice});
    return {};
  }

  Status add_fields(matvar_t& variable, const std::string& name, int depth) {
    std::size_t count = variable.rank > 0 ? 1 : 0;
    for (int k = 0; k < variable.rank && count <= kMostObjects; ++k) count *= variable.dims[k];
    const unsigned fields = Mat_VarGetNumberOfFields(&variable);
    char* const* const names = Mat_VarGetStructFieldnames(&variable);
    for (std::size_t k = 0; k < count; ++k)
      for (unsigned field = 0; field < fields; ++field) {
        matvar_t* const inner = Mat_VarGetStructFieldByIndex(&variable, field, k);
        const std::string path = name + "/" + (count > 1 ? std::to_string(k + 1) + "/" : "") + names[field];
        if (inner == nullptr) continue;
        if (Status added = add(*inner, path, depth + 1); !added) return added;
      }
    return {};
  }

  /// A matrix is as many vectors as it has columns.
  Status add_numbers(matvar_t& variable, const std::string& name) {
    const bool numeric = variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64;
    if (!numeric || variable.rank != 2) return {};
    const std::size_t rows = variable.dims[0], columns = variable.dims[1];
    const bool vector = rows == 1 || columns == 1;
    if (rows == 0 || columns == 0 || (!vector && (columns > kMostColumns || columns >= rows))) return {};
    if (rows > kMostNumbers || rows * columns > kMostNumbers - total_) return fail(variable_error(name, kTooMany));
    total_ += rows * columns;
    Result<std::vector<double>> all = read_vector(file_, &variable, name, rows * columns);
    if (!all) return fail(all.error());
    if (vector) found_.push_back({.name = name, .values = std::move(*all)});
    for (std::size_t column = 0; column < columns && !vector; ++column) {
      const auto begin = all->begin() + static_cast<std::ptrdiff_t>(column * rows);
      found_.push_back({.name = name + "/" + std::to_string(column + 1),
                        .values = std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(rows))});
    }
    return {};
  }

  static constexpr std::size_t kMostObjects = 10'000, kMostColumns = 256;
  static constexpr int kDeepest = 16;
  mat_t* file_;
  std::vector<MatVariable> found_;
  std::size_t objects_ = 0;
  std::size_t total_ = 0;
};

Result<std::vector<MatVariable>> read_all_vectors(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const MatFile file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) return fail("is damaged: MATLAB version 5 cannot be read from it");
  NestedVectors vectors(file.get());
  while (const Variable variable{Mat_VarReadNextInfo(file.get())})
    if (const Status added = vectors.add(*variable, variable->name != nullptr ? variable->name : "", 0); !added)
      return fail(added.error());
  return vectors.take();
}

/// One file at a time, as HDF5 in Debian's build is not safe for threads.
std::unique_lock<std::mutex> one_at_a_time() {
  static std::mutex mutex;
  return std::unique_lock<std::mutex>(mutex);
}

Error sample_error(const std::string& name, std::size_t row, double value, std::string rule) {
  return error_at("row " + std::to_string(row + 1) + ", column " + name, text::exact(value), std::move(rule));
}

/// All samples finite, all vectors as long as time, time increasing.
Status check(const ColumnarSamples& read) {
  const std::vector<double>& time = read.samples.time_s;
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (!std::isfinite(time[row])) return fail(sample_error("time", row, time[row], "must be a finite number"));
    if (row > 0 && time[row] <= time[row - 1])
      return fail(sample_error(
          "time", row, time[row],
          "time must increase from row to row: the one before is " + std::to_string(time[row - 1]) + " s"));
  }
  for (const Series& channel : read.samples.channels) {
    if (channel.values.size() != time.size())
      return fail(variable_error(
          channel.name,
          "has " + std::to_string(channel.values.size()) + " samples where time has " + std::to_string(time.size()),
          kTakeOutOrStore));
    for (std::size_t row = 0; row < time.size(); ++row)
      if (!std::isfinite(channel.values[row]))
        return fail(sample_error(channel.name, row, channel.values[row], "must be a finite number"));
  }
  return {};
}

}  // namespace

Result<ColumnarSamples> read_mat(const std::string& path, const PlantDescription& plant) {
  const auto lock = one_at_a_time();
  const Result<MatFormat> format = check_mat_container(path);
  if (!format) return fail(format.error());
  const auto read = [&] { return read_variables(path, plant); };
  Result<std::vector<MatVariable>> variables = *format == MatFormat::version_7_3 ? in_child(read) : read();
  if (!variables) return fail(variables.error());
  std::vector<std::string_view> cells;
  std::vector<std::vector<double>> values;
  for (MatVariable& variable : *variables) {
    cells.emplace_back(variable.name);
    values.push_back(std::move(variable.values));
  }
  Result<std::vector<Column>> columns = find_columns(cells, plant);
  if (!columns) return fail(columns.error());
  ColumnarSamples out = assemble(std::move(*columns), std::move(values));
  if (const Status status = check(out); !status) return fail(status.error());
  return out;
}

Result<std::vector<MatVariable>> read_mat_vectors(const std::string& path) {
  const auto lock = one_at_a_time();
  const Result<MatFormat> format = check_mat_container(path, true);
  if (!format) return fail(format.error());
  if (*format == MatFormat::version_7_3) return read_hdf5_vectors(path);  // with its structs, as groups
  const auto read = [&path] { return read_all_vectors(path); };
  return *format == MatFormat::version_5_nested ? in_child(read) : read();
}

}  // namespace sealwatch
