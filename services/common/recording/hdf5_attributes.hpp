// What the attributes of a data set say of its numbers: unit, packing, which numbers stand for none, MATLAB's class.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <string>
#include <vector>

namespace sealwatch {

/// An identifier of HDF5, closed at its end.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

inline constexpr std::size_t kLongestHdf5Name = 1000;

struct Hdf5Attributes {
  std::vector<std::string> units;      ///< one, or one a column of a table
  std::vector<std::string> names;      ///< of the columns of a matrix
  std::vector<double> no_values = {};  ///< numbers that stand for none, as they are stored
  double scale = 1.0, offset = 0.0;    ///< value = scale number + offset, as the CF conventions of NetCDF have it
  std::string other_scaling = {};      ///< "gain 0.01": said, and nobody says how it is meant
  std::string matlab_class = {};
  bool is_matlab_object = false;  ///< the data is not here
  bool is_matlab_empty = false;   ///< the numbers are dimensions
};

[[nodiscard]] Hdf5Attributes hdf5_attributes(hid_t dataset);

}  // namespace sealwatch
