#include "services/health_assessment/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch {
namespace {

/// Below half an advisory width nobody would call it a deviation.
constexpr double kNoticeable = 0.5;

std::string widths_text(const Deviation& deviation) {
  return text::format("{} ({:.1f} times the advisory deviation)", in_words(deviation.judgement),
                      std::abs(deviation.value));
}

/// Quantities at hand that one of the two faults moves and the other does not.
std::string separating(const Signature& one, const Signature& other, const std::vector<Deviation>& deviations) {
  std::string names;
  for (const Deviation& deviation : deviations) {
    const std::string& quantity = deviation.judgement.quantity;
    if (!deviation.informative || one.moves.count(quantity) == other.moves.count(quantity)) continue;
    text::add_to_list(names, text::in_words(quantity));
  }
  return names;
}

std::string separation_text(const ProposedFault& other, const std::string& names) {
  const std::string rival = text::in_words(name_of(other.kind)) + " (" + text::in_words(other.element) + ")";
  if (names.empty()) return "cannot be told apart from " + rival + " by the recorded channels";
  return "told apart from " + rival + " by " + names;
}

}  // namespace

void add_evidence(std::vector<Proposal>& proposals, const std::vector<Deviation>& deviations,
                  const std::map<std::string, SensorRemark>& remarks) {
  for (Proposal& proposal : proposals) {
    std::vector<std::string>& evidence = proposal.fault.evidence;
    for (const Deviation& deviation : deviations)
      if (proposal.signature.moves.count(deviation.judgement.quantity) != 0 && std::abs(deviation.value) >= kNoticeable)
        evidence.push_back(widths_text(deviation));
    if (const auto remark = remarks.find(proposal.fault.element); remark != remarks.end())
      evidence.push_back(remark->second.text);
    if (evidence.empty()) evidence.push_back("no quantity deviates noticeably; the prior alone");
    if (proposals.size() < 2) continue;
    const Proposal& rival = &proposal == &proposals.front() ? proposals[1] : proposals.front();
    evidence.push_back(separation_text(rival.fault, separating(proposal.signature, rival.signature, deviations)));
  }
}

}  // namespace sealwatch
