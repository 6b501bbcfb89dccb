// What the journal knows of others' numbers: rarely asked, so not prepared.
#include "services/common/store/database.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch {

using soci::into;
using soci::use;

Result<KnownInput> Journal::known_input(const Message& message) {
  return database_->guard("looking for an input", [&] {
    const Header& header = header_of(message);
    std::string writer;
    long long sequence = 0;
    database_->sql << "SELECT writer_id, sequence FROM inputs WHERE message_id = :message",
        use(header.message_id, "message"), into(writer), into(sequence);
    if (!database_->sql.got_data()) return KnownInput::no;
    const bool other = writer == header.writer_id && static_cast<std::uint64_t>(sequence) != header.stream_sequence;
    return other ? KnownInput::other_sequence : KnownInput::same;
  });
}

Status Journal::renumber_input(const Message& message) {
  return database_->guard("renumbering an input", [&] {
    const Header& header = header_of(message);
    const auto sequence = static_cast<long long>(header.stream_sequence);
    database_->sql << "UPDATE inputs SET sequence = :sequence WHERE message_id = :message AND writer_id = :writer",
        use(sequence, "sequence"), use(header.message_id, "message"), use(header.writer_id, "writer");
    ++database_->batch_rows;
  });
}

}  // namespace sealwatch
