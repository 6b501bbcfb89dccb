// One list of a struct's fields, written next to it, serves the DDS codec, the journal, JSON and the round-trip tests.
//
//   struct Point { double x_m; double y_m; SEALWATCH_FIELDS(Point, x_m, y_m) };
//   Point::visit(visitor, point);          // visitor("x_m", point.x_m); visitor("y_m", point.y_m);
//   Point::visit_pair(visitor, point, c);  // visitor("x_m", point.x_m, c.x_m); ... for any c with the same names
//
// SEALWATCH_ENUM gives an enum class its names the same way.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

// Applies MACRO to each argument (C++20 __VA_OPT__ recursion, up to 256 arguments).
#define SEALWATCH_PARENTHESES ()
#define SEALWATCH_EXPAND(...) SEALWATCH_EXPAND4(SEALWATCH_EXPAND4(SEALWATCH_EXPAND4(SEALWATCH_EXPAND4(__VA_ARGS__))))
#define SEALWATCH_EXPAND4(...) SEALWATCH_EXPAND3(SEALWATCH_EXPAND3(SEALWATCH_EXPAND3(SEALWATCH_EXPAND3(__VA_ARGS__))))
#define SEALWATCH_EXPAND3(...) SEALWATCH_EXPAND2(SEALWATCH_EXPAND2(SEALWATCH_EXPAND2(SEALWATCH_EXPAND2(__VA_ARGS__))))
#define SEALWATCH_EXPAND2(...) SEALWATCH_EXPAND1(SEALWATCH_EXPAND1(SEALWATCH_EXPAND1(SEALWATCH_EXPAND1(__VA_ARGS__))))
#define SEALWATCH_EXPAND1(...) __VA_ARGS__
#define SEALWATCH_FOR_EACH(macro, ...) __VA_OPT__(SEALWATCH_EXPAND(SEALWATCH_FOR_EACH_STEP(macro, __VA_ARGS__)))
#define SEALWATCH_FOR_EACH_STEP(macro, first, ...) \
  macro(first) __VA_OPT__(SEALWATCH_FOR_EACH_AGAIN SEALWATCH_PARENTHESES(macro, __VA_ARGS__))
#define SEALWATCH_FOR_EACH_AGAIN() SEALWATCH_FOR_EACH_STEP

#define SEALWATCH_VISIT_ONE(field) visitor(std::string_view(#field), self.field);
#define SEALWATCH_VISIT_TWO(field) visitor(std::string_view(#field), self.field, other.field);
#define SEALWATCH_COUNT_ONE(field) +1  // NOLINT(bugprone-macro-parentheses): a term of a sum

#define SEALWATCH_FIELDS(Type, ...)                                                                  \
  static constexpr std::string_view kTypeName = #Type;                                               \
  static constexpr std::size_t kFieldCount = 0 SEALWATCH_FOR_EACH(SEALWATCH_COUNT_ONE, __VA_ARGS__); \
  template <class Visitor, class Self>                                                               \
  static void visit(Visitor&& visitor, Self&& self) {                                                \
    SEALWATCH_FOR_EACH(SEALWATCH_VISIT_ONE, __VA_ARGS__)                                             \
  }                                                                                                  \
  template <class Visitor, class Self, class Other>                                                  \
  static void visit_pair(Visitor&& visitor, Self&& self, Other&& other) {                            \
    SEALWATCH_FOR_EACH(SEALWATCH_VISIT_TWO, __VA_ARGS__)                                             \
  }

namespace sealwatch {

/// A struct with SEALWATCH_FIELDS.
template <class T>
concept Described = requires {
  T::kFieldCount;
};

/// Names of an enum's values; specialised by SEALWATCH_ENUM. Values are 0, 1, 2, ...
template <class Enum>
struct EnumNames;

template <class Enum>
concept DescribedEnum = requires {
  EnumNames<Enum>::kNames;
};

template <DescribedEnum Enum>
[[nodiscard]] constexpr std::string_view name_of(Enum value) {
  const auto index = static_cast<std::size_t>(value);
  return index < EnumNames<Enum>::kNames.size() ? EnumNames<Enum>::kNames[index] : std::string_view("unknown");
}

template <DescribedEnum Enum>
[[nodiscard]] constexpr std::optional<Enum> value_of(std::string_view name) {
  for (std::size_t index = 0; index < EnumNames<Enum>::kNames.size(); ++index)
    if (EnumNames<Enum>::kNames[index] == name) return static_cast<Enum>(index);
  return std::nullopt;
}

}  // namespace sealwatch

#define SEALWATCH_NAME_ONE(value) std::string_view(#value),

/// Declares `enum class Type : std::int32_t { values... }` and its names. Use inside namespace sealwatch.
#define SEALWATCH_ENUM(Type, ...)                                                               \
  enum class Type : std::int32_t { __VA_ARGS__ };                                               \
  template <>                                                                                   \
  struct EnumNames<Type> {                                                                      \
    static constexpr std::array kNames = {SEALWATCH_FOR_EACH(SEALWATCH_NAME_ONE, __VA_ARGS__)}; \
  };
