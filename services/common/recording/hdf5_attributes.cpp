#include "services/common/recording/hdf5_attributes.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

constexpr hssize_t kMostTexts = 1000;

// As loggers, LabVIEW, NetCDF and people call them.
constexpr std::array kUnitNames = {"unit", "units", "Unit", "Units", "UNIT", "UNITS", "unit_string", "Unit_String"};
constexpr std::array kColumnNames = {"columns", "column_names", "labels", "names"};
constexpr std::array kNoValueNames = {"_FillValue", "missing_value"};
constexpr std::array kScaleNames = {"scale", "Scale", "gain", "Gain", "slope", "factor"};
constexpr std::array kOffsetNames = {"offset", "Offset", "bias", "intercept"};

std::vector<std::string> long_texts(hid_t attribute, hid_t type, std::size_t count) {
  std::vector<char*> texts(count, nullptr);
  if (H5Aread(attribute, type, static_cast<void*>(texts.data())) < 0) return {};
  std::vector<std::string> out;
  for (char* const text : texts) {
    out.emplace_back(text == nullptr ? "" : std::string(text, strnlen(text, kLongestHdf5Name)));
    if (text != nullptr) H5free_memory(text);
  }
  return out;
}

/// One text, or several of an array; none where the attribute is absent or no text.
std::vector<std::string> texts_of(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), &H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute.get()), &H5Tclose);
  if (!attribute || !type || H5Tget_class(type.get()) != H5T_STRING) return {};
  const Hdf5Handle space(H5Aget_space(attribute.get()), &H5Sclose);
  const hssize_t count = space ? H5Sget_simple_extent_npoints(space.get()) : 0;
  if (count < 1 || count > kMostTexts) return {};
  const auto number = static_cast<std::size_t>(count);
  if (H5Tis_variable_str(type.get()) > 0) return long_texts(attribute.get(), type.get(), number);
  const std::size_t size = H5Tget_size(type.get());
  std::string all(size <= kLongestHdf5Name ? size * number : 0, '\0');
  if (all.empty() || H5Aread(attribute.get(), type.get(), all.data()) < 0) return {};
  std::vector<std::string> out;
  for (std::size_t k = 0; k < number; ++k)
    out.emplace_back(all.data() + k * size, strnlen(all.data() + k * size, size));
  return out;
}

std::optional<double> number_of(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), &H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute.get()), &H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.get()), &H5Sclose);
  if (!attribute || !type || !space || H5Sget_simple_extent_npoints(space.get()) != 1) return std::nullopt;
  if (const H5T_class_t kind = H5Tget_class(type.get()); kind != H5T_INTEGER && kind != H5T_FLOAT) return std::nullopt;
  double value = 0.0;
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value) < 0) return std::nullopt;
  return value;
}

/// The first of attributes of these names whose number is not the one that changes nothing, in words.
std::string said_of(hid_t object, const auto& names, double nothing) {
  for (const char* const name : names)
    if (const std::optional<double> number = number_of(object, name); number && *number != nothing)
      return std::string(name) + " " + text::significant(*number, 6);
  return {};
}

std::vector<std::string> first_texts(hid_t object, const auto& names) {
  for (const char* const name : names)
    if (std::vector<std::string> texts = texts_of(object, name); !texts.empty() && !texts.front().empty()) return texts;
  return {};
}

}  // namespace

Hdf5Attributes hdf5_attributes(hid_t dataset) {
  Hdf5Attributes out{.units = first_texts(dataset, kUnitNames), .names = first_texts(dataset, kColumnNames)};
  for (const char* const name : kNoValueNames)
    if (const std::optional<double> number = number_of(dataset, name)) out.no_values.push_back(*number);
  out.scale = number_of(dataset, "scale_factor").value_or(1.0);
  out.offset = number_of(dataset, "add_offset").value_or(0.0);
  out.other_scaling = said_of(dataset, kScaleNames, 1.0);
  if (out.other_scaling.empty()) out.other_scaling = said_of(dataset, kOffsetNames, 0.0);
  const std::vector<std::string> matlab = texts_of(dataset, "MATLAB_class");
  if (!matlab.empty()) out.matlab_class = matlab.front();
  out.is_matlab_object = number_of(dataset, "MATLAB_object_decode").value_or(0.0) != 0.0;
  out.is_matlab_empty = number_of(dataset, "MATLAB_empty").value_or(0.0) != 0.0;
  return out;
}

}  // namespace sealwatch
