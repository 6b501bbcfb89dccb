// What became of alarms (journal.hpp), in table alarms: one row for each that is active or that somebody must still see.
#include "services/common/message/json.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {

using soci::into;
using soci::use;

Result<std::vector<AlarmEntry>> Journal::alarms() {
  return database_->guard("reading the alarms", [&] {
    std::vector<AlarmEntry> entries;
    std::string payload;
    std::string checksum;
    soci::statement statement = (database_->sql.prepare << "SELECT payload, checksum FROM alarms ORDER BY kind,"
                                                           " asset_id, subject",
                                 into(payload), into(checksum));
    statement.execute();
    while (statement.fetch()) {
      auto entry = row_checksum({payload}) == checksum ? alarm_from_json(payload) : fail("a damaged row");
      if (entry) entries.push_back(std::move(*entry));
    }
    return entries;
  });
}

Status Journal::keep_alarm(const AlarmEntry& entry) {
  return database_->guard("keeping an alarm", [&] {
    const std::string payload = to_json(entry);
    const std::string checksum = row_checksum({payload});
    database_->sql << "INSERT INTO alarms(kind, asset_id, subject, payload, checksum) VALUES(:kind, :asset, :subject,"
                      " :payload, :checksum) ON CONFLICT(kind, asset_id, subject) DO UPDATE SET"
                      " payload = excluded.payload, checksum = excluded.checksum",
        use(entry.alarm.kind, "kind"), use(entry.alarm.asset_id, "asset"), use(entry.alarm.subject, "subject"),
        use(payload, "payload"), use(checksum, "checksum");
    ++database_->batch_rows;
  });
}

Status Journal::forget_alarm(const ServiceAlarm& alarm) {
  return database_->guard("forgetting an alarm", [&] {
    database_->sql << "DELETE FROM alarms WHERE kind = :kind AND asset_id = :asset AND subject = :subject",
        use(alarm.kind, "kind"), use(alarm.asset_id, "asset"), use(alarm.subject, "subject");
    ++database_->batch_rows;
  });
}

}  // namespace sealwatch
