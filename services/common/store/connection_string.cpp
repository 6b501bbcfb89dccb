#include "services/common/store/connection_string.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "services/common/store/journal.hpp"

namespace sealwatch {
namespace {

constexpr std::string_view kMask = "***";
constexpr std::string_view kSpaces = " \t\n\r\f\v";
/// Keywords whose values are no secret; in lower case.
constexpr std::array<std::string_view, 28> kHarmless = {"host",
                                                        "hostaddr",
                                                        "port",
                                                        "db",
                                                        "dbname",
                                                        "user",
                                                        "options",
                                                        "service",
                                                        "application_name",
                                                        "sslmode",
                                                        "sslcert",
                                                        "sslrootcert",
                                                        "sslcrl",
                                                        "connect_timeout",
                                                        "client_encoding",
                                                        "timeout",
                                                        "keepalives",
                                                        "keepalives_idle",
                                                        "target_session_attrs",
                                                        "keepalives_interval",
                                                        "keepalives_count",
                                                        "tcp_user_timeout",
                                                        "gssencmode",
                                                        "channel_binding",
                                                        "krbsrvname",
                                                        "singlerow",
                                                        "singlerows",
                                                        "requirepeer"};
/// Those that libpq knows and whose values are secret: the keyword itself may be shown.
constexpr std::array<std::string_view, 4> kSecret = {"password", "sslpassword", "passfile", "sslkey"};
/// Shorter pieces of a secret are words of a complaint as well.
constexpr std::size_t kShortestPiece = 3;

std::string lower(std::string_view text) {
  std::string small(text);
  std::ranges::transform(small, small.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return small;
}

bool is_one_of(std::string_view keyword, const auto& list) {
  return std::ranges::find(list, lower(keyword)) != list.end();
}

/// Letters, digits and these alone.
bool is_plain(std::string_view text, std::string_view others) {
  return std::ranges::all_of(text, [&](unsigned char letter) {
    return std::isalnum(letter) != 0 || others.find(static_cast<char>(letter)) != std::string_view::npos;
  });
}

/// As libpq reads what is percent-encoded.
std::string decoded(std::string_view text) {
  std::string bytes;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const bool encoded = text[k] == '%' && k + 2 < text.size() &&
                         std::isxdigit(static_cast<unsigned char>(text[k + 1])) != 0 &&
                         std::isxdigit(static_cast<unsigned char>(text[k + 2])) != 0;
    bytes += encoded ? static_cast<char>(std::stoi(std::string(text.substr(k + 1, 2)), nullptr, 16)) : text[k];
    k += encoded ? 2 : 0;
  }
  return bytes;
}

class Masking {
 public:
  explicit Masking(std::string_view text) : rest_(text) {}

  ShownConnection words() {
    for (;;) {
      show(rest_.substr(0, rest_.find_first_not_of(kSpaces)));
      if (rest_.empty()) break;
      if (!word()) {
        mask(rest_);
        break;
      }
    }
    return std::move(shown_);
  }

  /// [user[:password]@]host[/db][?keyword=value&...]. A password with a "/" or "@" in it that is not encoded is not read
  /// by libpq as it was meant: it goes from the first ":" to the last "@".
  ShownConnection uri() {
    if (const std::size_t at = rest_.rfind('@'); at != std::string_view::npos) {
      const std::string_view who = rest_.substr(0, at);
      const std::string_view user = who.substr(0, who.find(':'));
      show_if(is_plain(user, "_.-"), user);
      if (user.size() < who.size()) {
        show(":");
        mask(rest_.substr(0, at - user.size() - 1));
      }
      show("@");
    }
    const std::string_view base = rest_.substr(0, rest_.find('?'));
    show_if(is_plain(base, "_.-:,/[]%") && has_numbers_as_ports(base), base);
    while (!rest_.empty()) parameter();
    return std::move(shown_);
  }

 private:
  /// After the ":" of each host: what is no number there may be a part of a password.
  static bool has_numbers_as_ports(std::string_view base) {
    const std::string_view hosts = base.substr(0, base.find('/'));
    for (std::size_t colon = hosts.find(':'); colon != std::string_view::npos; colon = hosts.find(':', colon + 1)) {
      if (hosts.find(']', colon) != std::string_view::npos) continue;  // of an IPv6 address
      const std::string_view port = hosts.substr(colon + 1, hosts.find(',', colon) - colon - 1);
      if (!std::ranges::all_of(port, [](unsigned char digit) { return std::isdigit(digit) != 0; })) return false;
    }
    return true;
  }
  void show(std::string_view text) {
    shown_.text += text;
    rest_.remove_prefix(std::min(text.size(), rest_.size()));
  }
  void mask(std::string_view text) {
    shown_.text += kMask;
    shown_.secrets.emplace_back(text);
    shown_.secrets.push_back(decoded(text));
    rest_.remove_prefix(text.size());
  }
  void show_if(bool harmless, std::string_view text) { harmless ? show(text) : mask(text); }

  /// keyword = value; false where libpq would read no more.
  bool word() {
    const std::string_view keyword = rest_.substr(0, rest_.find_first_of("= \t\n\r\f\v"));
    const std::size_t equals = rest_.find_first_not_of(kSpaces, keyword.size());
    if (equals == std::string_view::npos || rest_[equals] != '=') return false;
    const std::size_t begin = std::min(rest_.find_first_not_of(kSpaces, equals + 1), rest_.size());
    const auto end = end_of_value(begin);
    if (!end) return false;
    const std::string_view space = rest_.substr(keyword.size(), begin - keyword.size());
    const std::string_view value = rest_.substr(begin, *end - begin);
    const bool known = is_one_of(keyword, kHarmless);
    const bool harmless = known && value.find("://") == std::string_view::npos;
    show_if(known || is_one_of(keyword, kSecret), keyword);
    show(space);
    harmless ? show(value) : mask_value(value);
    return true;
  }

  /// Of the value that begins there; nothing where a quote does not end.
  [[nodiscard]] std::optional<std::size_t> end_of_value(std::size_t begin) const {
    const bool quoted = begin < rest_.size() && rest_[begin] == '\'';
    for (std::size_t k = begin + (quoted ? 1 : 0); k < rest_.size(); ++k) {
      if (rest_[k] == '\\')
        ++k;
      else if (quoted && rest_[k] == '\'')
        return k + 1;
      else if (!quoted && kSpaces.find(rest_[k]) != std::string_view::npos)
        return k;
    }
    return quoted ? std::nullopt : std::optional(rest_.size());
  }

  void mask_value(std::string_view value) {
    std::string read;  // as libpq does
    for (std::size_t k = 0; k < value.size(); ++k)
      if (value[k] == '\\' && k + 1 < value.size())
        read += value[++k];
      else if (value[k] != '\'')
        read += value[k];
    shown_.secrets.push_back(std::move(read));
    mask(value);
  }

  void parameter() {
    show(rest_.substr(0, 1));  // "?" or "&"
    const std::string_view one = rest_.substr(0, rest_.find('&'));
    const std::string_view keyword = one.substr(0, one.find('='));
    const bool harmless = is_one_of(keyword, kHarmless);
    show_if(harmless || is_one_of(keyword, kSecret), keyword);
    if (keyword.size() == one.size()) return;
    show("=");
    show_if(harmless && is_plain(one.substr(keyword.size() + 1), "_.-:,/[]%"), one.substr(keyword.size() + 1));
  }

  std::string_view rest_;
  ShownConnection shown_;
};

/// What libpq and people take for one: it has no keyword at its beginning.
bool is_uri(std::string_view text) {
  return text.substr(0, text.find_first_of("= \t\n\r\f\v")).find_first_of("@:/?") != std::string_view::npos;
}

void replace_all(std::string& text, const std::string& piece) {
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + kMask.size()))
    text.replace(at, piece.size(), kMask);
}

/// Whole and in the pieces that libpq may have taken for something else.
void remove_secret(std::string& text, const std::string& secret) {
  if (secret.size() >= kShortestPiece) replace_all(text, secret);
  for (std::size_t begin = 0; begin < secret.size();) {
    const std::size_t end = std::min(secret.find_first_of(" \t\n\r\f\v:/@?&='\"\\,", begin), secret.size());
    const std::string piece = secret.substr(begin, end - begin);
    if (piece.size() >= kShortestPiece)
      replace_all(text, piece);
    else if (!piece.empty())
      replace_all(text, '"' + piece + '"');
    begin = end + 1;
  }
}

}  // namespace

ShownConnection shown(const std::string& connection) {
  const std::string_view all = connection;
  const std::size_t colon = all.find("://");
  const bool has_kind = colon != std::string_view::npos && is_plain(all.substr(0, colon), "");
  const std::string_view kind = all.substr(0, has_kind ? colon + 3 : 0);
  std::string_view rest = all.substr(kind.size());
  if (kind == "sqlite3://" || is_plain(all, "_.-/")) return {.text = connection};  // a file
  std::string before(kind);
  for (const std::string_view again : {"postgresql://", "postgres://"})
    if (rest.starts_with(again)) {
      before += again;
      rest.remove_prefix(again.size());
    }
  ShownConnection masked = is_uri(rest) || before.size() > kind.size() ? Masking(rest).uri() : Masking(rest).words();
  masked.text.insert(0, before);
  return masked;
}

std::string without_password(const std::string& connection) { return shown(connection).text; }

std::string without_secrets_of(const std::string& connection, std::string text) {
  std::vector<std::string> secrets = shown(connection).secrets;
  std::ranges::sort(secrets, std::ranges::greater(), &std::string::size);  // one may be part of another
  for (const std::string& secret : secrets) remove_secret(text, secret);
  return text;
}

void open_session(soci::session& sql, const std::string& connection) {
  try {
    sql.open(connection);
  } catch (const std::exception& exception) {
    throw std::runtime_error(without_secrets_of(connection, exception.what()));
  }
}

}  // namespace sealwatch
