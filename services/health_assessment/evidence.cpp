#include "services/health_assessment/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace sealwatch {
namespace {

/// Below half an advisory width nobody would call it a deviation.
constexpr double kNoticeable = 0.5;

/// All quantities that a fault moves, over its signatures.
std::set<std::string> moved_by(const ProposedFault& fault, const std::vector<Signature>& signatures) {
  std::set<std::string> quantities;
  for (const Signature& signature : signatures)
    if (signature.kind == fault.kind && signature.element == fault.element)
      for (const auto& [quantity, move] : signature.moves) quantities.insert(quantity);
  return quantities;
}

std::string widths_text(const Deviation& deviation) {
  char text[60];
  std::snprintf(text, sizeof text, " (%+.1f advisory widths)", deviation.value);
  return in_words(deviation.judgement) + text;
}

/// Quantities at hand that one of the two faults moves and the other does not.
std::string separating(const std::set<std::string>& one, const std::set<std::string>& other,
                       const std::vector<Deviation>& deviations) {
  std::string names;
  for (const Deviation& deviation : deviations) {
    const std::string& quantity = deviation.judgement.quantity;
    if (!deviation.informative || one.count(quantity) == other.count(quantity)) continue;
    names += (names.empty() ? "" : ", ") + quantity;
  }
  return names;
}

std::string separation_text(const ProposedFault& other, const std::string& names) {
  const std::string rival = std::string(name_of(other.kind)) + " (" + other.element + ")";
  if (names.empty()) return "cannot be told apart from " + rival + " by the recorded channels";
  return "told apart from " + rival + " by " + names;
}

}  // namespace

void add_evidence(std::vector<ProposedFault>& faults, const std::vector<Deviation>& deviations,
                  const std::vector<Signature>& signatures, const std::map<std::string, SensorRemark>& remarks) {
  for (ProposedFault& fault : faults) {
    const std::set<std::string> moved = moved_by(fault, signatures);
    for (const Deviation& deviation : deviations)
      if (moved.count(deviation.judgement.quantity) != 0 && std::abs(deviation.value) >= kNoticeable)
        fault.evidence.push_back(widths_text(deviation));
    if (const auto remark = remarks.find(fault.element); remark != remarks.end())
      fault.evidence.push_back(remark->second.text);
    if (fault.evidence.empty()) fault.evidence.push_back("no quantity deviates noticeably; the prior alone");
    const ProposedFault* rival =
        &fault == &faults.front() ? (faults.size() > 1 ? &faults[1] : nullptr) : &faults.front();
    if (rival != nullptr)
      fault.evidence.push_back(separation_text(*rival, separating(moved, moved_by(*rival, signatures), deviations)));
  }
}

}  // namespace sealwatch
