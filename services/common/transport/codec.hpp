// From sealwatch's message structs to the C structs that idlc generates from idl/, driven by the field lists of
// SEALWATCH_FIELDS: every field of a struct is visited together with the C member of the same name, so a field that the
// IDL lacks, or has with another type, does not compile; nor does a C member that the C++ struct lacks. The way back does
// without C structs (from_cdr.hpp).
//
// LendToDds copies nothing: strings and numbers are lent to the C struct; only the arrays of pointers and of structs that
// C needs are made, in a memory resource that must outlive the C struct, like the message itself. Nothing is to be freed.
// For dds_write, which copies into its own serialised form.
//
// A string ends at its first NUL on the wire, as strings in IDL do.
#pragma once

#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch::transport {

namespace detail {

/// Stands for a value of any type, to find out how many initialisers an aggregate takes.
struct AnyValue {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): never defined, only named
};

template <class Aggregate, std::size_t... Index>
consteval bool takes(std::index_sequence<Index...> /*count*/) {
  return requires { Aggregate{(static_cast<void>(Index), AnyValue{})...}; };
}

}  // namespace detail

/// How many members a C struct has.
template <class Aggregate, std::size_t Count = 1>
consteval std::size_t member_count() {
  if constexpr (detail::takes<Aggregate>(std::make_index_sequence<Count + 1>{}))
    return member_count<Aggregate, Count + 1>();
  else
    return Count;
}

/// A sequence as idlc generates it.
template <class T>
concept DdsSequence = requires(T sequence) {
  { sequence._length } -> std::same_as<std::uint32_t&>;
  sequence._buffer[0];
};

template <DdsSequence Sequence>
using ElementOf = std::remove_pointer_t<decltype(Sequence::_buffer)>;

class LendToDds {
 public:
  explicit LendToDds(std::pmr::memory_resource& memory) : memory_(memory) {}

  template <class From, class To>
  void operator()(std::string_view /*field*/, const From& from, To& to) const {
    lend(from, to);
  }

  template <Described From, class To>
  void lend(const From& from, To& to) const {
    static_assert(From::kFieldCount == member_count<To>(), "the IDL struct has a member that SEALWATCH_FIELDS lacks");
    From::visit_pair(*this, from, to);
  }

 private:
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void lend(const Number& from, Number& to) const { to = from; }
  template <DescribedEnum From, class To>
  requires std::is_enum_v<To>
  void lend(const From& from, To& to) const { to = static_cast<To>(from); }
  void lend(const std::string& from, char*& to) const { to = const_cast<char*>(from.c_str()); }

  template <class From, DdsSequence To>
  void lend(const std::vector<From>& from, To& to) const {
    assert(from.size() <= std::numeric_limits<std::uint32_t>::max());
    to._length = to._maximum = static_cast<std::uint32_t>(from.size());
    to._release = false;
    if constexpr (std::is_same_v<From, ElementOf<To>>) {
      to._buffer = const_cast<From*>(from.data());
    } else {
      to._buffer = from.empty() ? nullptr : allocate<ElementOf<To>>(from.size());
      for (std::size_t k = 0; k < from.size(); ++k) lend(from[k], to._buffer[k]);
    }
  }

  template <class T>
  T* allocate(std::size_t count) const {
    T* const items = static_cast<T*>(memory_.allocate(count * sizeof(T), alignof(T)));
    for (std::size_t k = 0; k < count; ++k) new (items + k) T{};
    return items;
  }

  std::pmr::memory_resource& memory_;
};

}  // namespace sealwatch::transport
