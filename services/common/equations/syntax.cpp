#include "services/common/equations/syntax.hpp"

#include <cctype>
#include <charconv>
#include <cmath>

namespace sealwatch::equations {
namespace {

constexpr int kDeepest = 100;  // brackets, signs and powers within each other
constexpr int kMost = 5000;    // numbers and names in one expression

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool continues_name(char c) { return begins_name(c) || std::isdigit(static_cast<unsigned char>(c)) != 0; }

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Result<Syntax> parse() {
    Syntax all = sum();
    if (!failed_ && peek() != '\0')
      fault("is not expected here", peek() == ')'
                                        ? "it closes no bracket: one may be missing before, or this is too much"
                                        : "an operator (+ - * / ^) may be missing before it");
    if (failed_) return fail(error_);
    return all;
  }

 private:
  char peek() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) { return peek() == c && (++at_, true); }

  void fault(std::string rule, std::string advice) {
    if (failed_) return;
    failed_ = true;
    error_ = Error{.file = {},
                   .place = "character " + std::to_string(at_ + 1),
                   .value = at_ < text_.size() ? std::string(text_.substr(at_)) : std::string(text_),
                   .rule = std::move(rule),
                   .advice = std::move(advice)};
    at_ = text_.size();
  }

  static Syntax joined(Syntax::Kind kind, Syntax a, Syntax b) {
    Syntax both{.kind = kind, .text = {}, .unit = {}, .begin = a.begin, .end = b.end};
    both.operands.push_back(std::move(a));
    both.operands.push_back(std::move(b));
    return both;
  }

  Syntax sum() {
    if (++depth_ > kDeepest) fault("is nested too deeply", "name parts of it under `definitions`");
    Syntax left = product();
    while (peek() == '+' || peek() == '-') {
      const bool adds = text_[at_++] == '+';
      left = joined(adds ? Syntax::Kind::add : Syntax::Kind::subtract, std::move(left), product());
    }
    refuse_choice();
    --depth_;
    return left;
  }

  /// What other languages choose with: "x > 0 ? a : b".
  void refuse_choice() {
    if (!failed_ && std::string_view("<>=?&|!").find(peek()) != std::string_view::npos && peek() != '\0')
      fault("is not an operator", "a choice is made with step(a, width), a bound with min or max(a, b, width)");
  }

  Syntax product() {
    Syntax left = with_sign();
    while (peek() == '*' || peek() == '/') {
      const bool multiplies = text_[at_++] == '*';
      if (peek() == '*') fault("is not an operator", "a power is written a^b");
      left = joined(multiplies ? Syntax::Kind::multiply : Syntax::Kind::divide, std::move(left), with_sign());
    }
    return left;
  }

  Syntax with_sign() {
    if (++depth_ > kDeepest) fault("is nested too deeply", "name parts of it under `definitions`");
    Syntax result;
    const char sign = peek();
    if (sign == '-' || sign == '+') {
      const std::size_t begin = at_++;
      Syntax of = with_sign();
      result = {.kind = Syntax::Kind::negate, .text = {}, .unit = {}, .begin = begin, .end = of.end};
      if (sign == '+')
        result = std::move(of);
      else
        result.operands.push_back(std::move(of));
    } else {
      result = primary();
      if (take('^')) result = joined(Syntax::Kind::power, std::move(result), with_sign());
    }
    --depth_;
    return result;
  }

  Syntax primary() {
    const char c = peek();
    if (++parts_ > kMost) return fault("is too long", "name parts of it under `definitions`"), Syntax{};
    if (c == '(') {
      ++at_;
      Syntax inner = sum();
      if (!take(')')) fault("comes where a closing bracket should", "add )");
      return inner;
    }
    if (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.') return number();
    if (begins_name(c)) return name();
    if (c == '\0')
      fault("ends where a number, a name or a bracket should follow", {});
    else
      fault("is not a number, a name or a bracket", {});
    return {};
  }

  Syntax number() {
    Syntax number{.kind = Syntax::Kind::number, .text = {}, .unit = {}, .begin = at_, .end = at_};
    const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), number.number);
    if (read.ec != std::errc{} || !std::isfinite(number.number)) return fault("is not a number", {}), number;
    number.end = at_ = static_cast<std::size_t>(read.ptr - text_.data());
    number.text = text_.substr(number.begin, number.end - number.begin);
    if (take('[')) {
      const std::size_t close = text_.find(']', at_);
      if (close == std::string_view::npos) return fault("is a unit without its end", "add ]"), number;
      number.unit = text_.substr(at_, close - at_);
      number.end = at_ = close + 1;
    }
    return number;
  }

  Syntax name() {
    Syntax name{.kind = Syntax::Kind::name, .text = {}, .unit = {}, .begin = at_, .end = at_};
    while (at_ < text_.size() && continues_name(text_[at_])) ++at_;
    name.end = at_;
    name.text = text_.substr(name.begin, at_ - name.begin);
    if (!take('(')) return name;
    name.kind = Syntax::Kind::call;
    do name.operands.push_back(sum());
    while (take(','));
    if (!take(')')) fault("comes where a comma or a closing bracket should", "add )");
    name.end = at_;
    return name;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0, parts_ = 0;
  bool failed_ = false;
  Error error_;
};

}  // namespace

Result<Syntax> parse(std::string_view text) { return Parser(text).parse(); }

}  // namespace sealwatch::equations
