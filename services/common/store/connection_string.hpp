// What of a connection string may be shown, and what of a refusal to connect: both go into logs, status messages and
// terminals. libpq takes three spellings, and echoes what it cannot read of any of them:
//
//   keyword = value   keyword='it\'s one value'     spaces around "=", quotes, escapes
//   postgresql://user:password@host/db?keyword=value   percent-encoded
//
// What is shown is what is known to be harmless: values of a list of keywords. The rest is masked, as is all that
// follows on something which libpq would not understand either.
#pragma once

#include <soci/soci.h>

#include <string>
#include <vector>

namespace sealwatch {

struct ShownConnection {
  std::string text;                       ///< without what is secret
  std::vector<std::string> secrets = {};  ///< what was masked, as written and as libpq reads it
};

[[nodiscard]] ShownConnection shown(const std::string& connection);
/// `text` without what of the connection string is secret.
[[nodiscard]] std::string without_secrets_of(const std::string& connection, std::string text);
/// Opens the session; what it throws echoes no secret.
void open_session(soci::session& sql, const std::string& connection);

}  // namespace sealwatch
