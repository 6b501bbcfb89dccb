// No password of a connection string is shown, however libpq lets it be written, nor echoed when it cannot be read.
#include "services/common/store/connection_string.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/store/journal.hpp"

namespace sealwatch {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ConnectionString, ShowsWhatIsHarmless) {
  for (const std::string harmless :
       {"sqlite3:///var/lib/sealwatch/a.db", "sqlite3://dbname=/var/j.db timeout=5", "postgresql://dbname=x",
        "postgresql://host=db dbname=sealwatch user=sealwatch options='-c search_path=state_detection'",
        "postgresql://postgresql://user@h:5432/db?sslmode=require", "postgresql://", "x.db"})
    EXPECT_EQ(without_password(harmless), harmless);
}

TEST(ConnectionString, MasksThePasswordHoweverItIsWritten) {
  const std::vector<std::pair<std::string, std::string>> spellings = {
      {"postgresql://dbname=x password=s3cret user=u", "postgresql://dbname=x password=*** user=u"},
      {"postgresql://password='s3cret' dbname=x", "postgresql://password=*** dbname=x"},
      {"postgresql://password = s3cret dbname=x", "postgresql://password = *** dbname=x"},
      {"postgresql://password='it\\'s s3cret' dbname=x", "postgresql://password=*** dbname=x"},
      {"postgresql://password=my\\ s3cret dbname=x", "postgresql://password=*** dbname=x"},
      {"postgresql://PassWord=s3cret\tdbname=x", "postgresql://PassWord=***\tdbname=x"},
      {"postgresql://sslpassword=s3cret password=s3cret", "postgresql://sslpassword=*** password=***"},
      {"postgresql://password=a dbname=x password=s3cret", "postgresql://password=*** dbname=x password=***"},
      {"postgresql://u:s3cret@h/db", "postgresql://u:***@h/db"},
      {"postgresql://postgres://u:s3/c@ret@h:5432/db", "postgresql://postgres://u:***@h:5432/db"},
      {"postgresql://postgresql://h/db?password=s3cret&user=u&sslpassword=s3cret",
       "postgresql://postgresql://h/db?password=***&user=u&sslpassword=***"},
      {"postgresql://postgresql://h/db?pass%77ord=s3cret", "postgresql://postgresql://h/db?***=***"},
      {"postgresql://dbname='postgresql://u:s3cret@h/db'", "postgresql://dbname=***"},
      {"postgresql://dbname=x pasword=s3cret", "postgresql://dbname=x ***=***"},
      {"password=s3cret", "password=***"},
      {"mysql://db=x password=s3cret", "mysql://db=x password=***"}};
  for (const auto& [connection, shown] : spellings) EXPECT_EQ(without_password(connection), shown) << connection;
}

TEST(ConnectionString, MasksWhatCannotBeRead) {
  for (const std::string unreadable :
       {"postgresql://dbname=x password='s3cret", "postgresql://dbname=x password s3cret",
        "postgresql://dbname=x password=top s3cret", "postgresql://u:s3cret@h/db password=s3cret",
        "postgresql://h/db?user=a@s3cret@h", "user=x password=s3cret://b", "postgresql:/u:s3cret@h"})
    EXPECT_THAT(without_password(unreadable), Not(HasSubstr("s3cret"))) << unreadable;
}

/// What libpq says of these echoes a part of them; the server at port 1 never answers.
TEST(ConnectionString, IsNotEchoedByARefusal) {
  for (const std::string connection :
       {"postgresql://u:s3cret@127.0.0.1:1/db", "postgresql://host=127.0.0.1 port=1 password=top s3cret",
        "postgresql://host=127.0.0.1 port=1 s3cret=password", "postgresql://postgresql://u:s3cret/x@127.0.0.1:1/db",
        "postgresql://postgresql://127.0.0.1:1/db?password=s3cret%zz",
        "postgresql://postgresql://127.0.0.1:1/db?s3cret=x", "postgresql://postgresql://u:s3%63ret@127.0.0.1:s3cret/db",
        "postgresql://host=127.0.0.1 port=1 password='s3cret"}) {
    const Status reached = Journal::check(connection);
    ASSERT_FALSE(reached.has_value()) << connection;
    EXPECT_THAT(reached.error().describe(), Not(HasSubstr("s3cret"))) << connection;
    const auto opened = Journal::open(connection, "state_detection");
    ASSERT_FALSE(opened.has_value()) << connection;
    EXPECT_THAT(opened.error().describe(), Not(HasSubstr("s3cret"))) << connection;
  }
}

TEST(ConnectionString, ShortPartsOfASecretAreMaskedWhereTheyAreQuoted) {
  EXPECT_EQ(without_secrets_of("postgresql://password=a b", "missing \"=\" after \"b\" in a string"),
            "missing \"=\" after *** in a string");
}

}  // namespace
}  // namespace sealwatch
