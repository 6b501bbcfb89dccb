#include "services/common/equations/tape.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::equations {

Tape::Tape(const Expressions& expressions, std::span<const Node> results, const std::vector<bool>& fixed)
    : tables_(std::make_shared<std::vector<Table>>(expressions.tables())), registers_(fixed.size(), 0.0) {
  const std::vector<Expressions::Entry>& entries = expressions.entries();
  std::vector<bool> needed(entries.size(), false), once(entries.size(), false);
  std::vector<std::uint32_t> place(entries.size(), 0);
  const auto operands = [](const Expressions::Entry& entry) {
    const bool leaf = entry.operation <= Operation::variable, table = entry.operation == Operation::table;
    return std::pair(!leaf && !table,
                     table || (entry.operation >= Operation::add && entry.operation <= Operation::power));
  };
  for (const Node node : results) needed[node] = true;
  for (std::size_t node = entries.size(); node-- > 0;) {
    if (!needed[node]) continue;
    const auto [first, second] = operands(entries[node]);
    if (first) needed[entries[node].a] = true;
    if (second) needed[entries[node].b] = true;
  }
  for (std::size_t node = 0; node < entries.size(); ++node) {
    if (!needed[node]) continue;
    const Expressions::Entry& entry = entries[node];
    if (entry.operation == Operation::variable) {
      place[node] = entry.a;
      once[node] = fixed[entry.a];
      continue;
    }
    place[node] = static_cast<std::uint32_t>(registers_.size());
    registers_.push_back(entry.number);
    const auto [first, second] = operands(entry);
    once[node] = (!first || once[entry.a]) && (!second || once[entry.b]);
    if (entry.operation == Operation::constant) continue;
    (once[node] ? once_ : always_)
        .push_back({entry.operation, place[node], first ? place[entry.a] : entry.a, second ? place[entry.b] : 0U});
  }
  for (const Node node : results) results_.push_back(place[node]);
}

void Tape::run(const std::vector<Instruction>& instructions, double* r) const {
  for (const Instruction& i : instructions) {
    switch (i.operation) {
      case Operation::add:
        r[i.to] = r[i.a] + r[i.b];
        break;
      case Operation::subtract:
        r[i.to] = r[i.a] - r[i.b];
        break;
      case Operation::multiply:
        r[i.to] = r[i.a] * r[i.b];
        break;
      case Operation::divide:
        r[i.to] = r[i.a] / r[i.b];
        break;
      case Operation::negate:
        r[i.to] = -r[i.a];
        break;
      case Operation::table:
        r[i.to] = (*tables_)[i.a / kOrdersOfTable].value(r[i.b], static_cast<int>(i.a % kOrdersOfTable));
        break;
      default:
        r[i.to] = evaluate(i.operation, r[i.a], r[i.b]);
    }
  }
}

}  // namespace sealwatch::equations
