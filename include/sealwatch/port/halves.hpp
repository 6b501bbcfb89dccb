// Messages that wait for another one about the same test, in the order of receipt.
//
// A writer's stream brings an asset's tests in their order, on each topic: one whose other half is not there when that of
// a later test is, was overtaken. It may be forged, or its other half set aside: it holds up no later test, waits on in
// case that is tried again, and of those that were overtaken only the last few do.
//
// However many wait, the memory is bounded: of all but the last few, what they say is let go of. The runner has it, and
// gives it again when the other half is there (Conclusion::again).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sealwatch/port/layer.hpp"

namespace sealwatch {

template <class Half>
class Halves {
 public:
  static constexpr std::size_t kMostOvertaken = 16;
  static constexpr std::size_t kMostKept = 16;  ///< with what they say
  /// No test waits behind so many: seventy years of weekly ones.
  static constexpr std::size_t kMostWaiting = 4096;

  /// What it is known by: its test or, of no test, its own id.
  [[nodiscard]] static const std::string& key_of(const Header& header) {
    return header.pst_id.empty() ? header.message_id : header.pst_id;
  }

  /// It begins to wait, or is here again.
  void add(const Half& half, Conclusion& conclusion) {
    asset_id_ = half.asset_id;
    const auto [known, is_new] = numbers_.try_emplace(key_of(half.header), next_);
    if (is_new) {
      waiting_.emplace_hint(waiting_.end(), next_++, Waiting{half.header.pst_id, half.header.message_id, nullptr});
    } else if (waiting_.at(known->second).message_id != half.header.message_id) {
      conclusion.consumed.push_back(half.header.message_id);
      conclusion.refused.push_back({half, "'" + waiting_.at(known->second).message_id + "' says the same already"});
      return;
    }
    keep(known->second, half);
    if (waiting_.size() > kMostWaiting) forget_first("too many wait behind it", conclusion);
  }
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  /// How many wait in vain, as it seems: the first ones.
  [[nodiscard]] std::size_t overtaken() const {
    return static_cast<std::size_t>(std::distance(waiting_.begin(), waiting_.lower_bound(overtaken_)));
  }
  /// The same, and those of whose tests that is true.
  template <class Predicate>
  [[nodiscard]] std::size_t overtaken_or(const Predicate& is_meant) const {
    return static_cast<std::size_t>(std::ranges::count_if(
        waiting_, [&](const auto& one) { return one.first < overtaken_ || is_meant(one.second.pst_id); }));
  }
  [[nodiscard]] bool has(const std::string& key) const { return numbers_.contains(key); }
  /// Whether what it says is here; if not, it is asked for.
  [[nodiscard]] bool is_here(const std::string& key, Conclusion& conclusion) const {
    const Waiting& one = waiting_.at(numbers_.at(key));
    if (!one.half) conclusion.again.push_back(one.message_id);
    return one.half != nullptr;
  }
  /// The first that was not overtaken, and is of no test: its key. Only of those before `key`'s, if that is given.
  [[nodiscard]] std::optional<std::string> first_of_no_test(const std::string& before = {}) const {
    const auto end = before.empty() ? next_ : numbers_.at(before);
    if (end <= overtaken_) return std::nullopt;
    const auto found = std::find_if(waiting_.lower_bound(overtaken_), waiting_.lower_bound(end),
                                    [](const auto& entry) { return entry.second.pst_id.empty(); });
    return found == waiting_.lower_bound(end) ? std::nullopt : std::optional(found->second.message_id);
  }
  /// Whether nothing that was not overtaken waits before it.
  [[nodiscard]] bool is_next(const std::string& key) const {
    const auto first = waiting_.lower_bound(overtaken_);
    return first != waiting_.end() && first->first == numbers_.at(key);
  }
  /// The one of that key, which is here, waits no longer, and has overtaken those before it.
  Half take(const std::string& key, Conclusion& conclusion) {
    Half half = *waiting_.at(numbers_.at(key)).half;
    (void)drop(key, conclusion);
    return half;
  }
  /// Likewise, whether or not it is here; returns its message id.
  std::string drop(const std::string& key, Conclusion& conclusion) {
    const std::uint64_t number = numbers_.at(key);
    std::string message_id = waiting_.at(number).message_id;
    erase(waiting_.find(number));
    overtaken_ = std::max(overtaken_, number);
    while (overtaken() > kMostOvertaken) forget_first("that of later tests did", conclusion);
    return message_id;
  }
  /// Those of whose tests that is true wait no longer: returns their message ids. They overtake nobody.
  template <class Predicate>
  std::vector<std::string> drop_if(const Predicate& is_meant) {
    std::vector<std::string> ids;
    for (auto one = waiting_.begin(); one != waiting_.end();) {
      const auto next = std::next(one);
      if (is_meant(one->second.pst_id)) {
        ids.push_back(one->second.message_id);
        erase(one);
      }
      one = next;
    }
    return ids;
  }

 private:
  struct Waiting {
    std::string pst_id;
    std::string message_id;
    std::unique_ptr<const Half> half;
  };
  using Place = typename std::map<std::uint64_t, Waiting>::iterator;

  void keep(std::uint64_t number, const Half& half) {
    if (kept_.insert(number).second && kept_.size() > kMostKept) {
      const auto first = *kept_.begin() == number ? std::next(kept_.begin()) : kept_.begin();
      waiting_.at(*first).half.reset();
      kept_.erase(first);
    }
    waiting_.at(number).half = std::make_unique<const Half>(half);
  }
  void erase(Place place) {
    kept_.erase(place->first);
    numbers_.erase(place->second.pst_id.empty() ? place->second.message_id : place->second.pst_id);
    waiting_.erase(place);
  }
  void forget_first(const char* why, Conclusion& conclusion) {
    const Waiting& first = waiting_.begin()->second;
    Half told = first.half ? *first.half : Half{};
    told.asset_id = asset_id_;
    told.header.pst_id = first.pst_id;
    told.header.message_id = first.message_id;
    conclusion.consumed.push_back(first.message_id);
    std::string reason = "what else belongs to test " + first.pst_id + " did not come, and " + why;
    conclusion.refused.push_back({std::move(told), std::move(reason)});
    erase(waiting_.begin());
  }

  std::string asset_id_;
  std::map<std::uint64_t, Waiting> waiting_;                ///< by their number, in the order of receipt
  std::unordered_map<std::string, std::uint64_t> numbers_;  ///< by their key
  std::uint64_t next_ = 0;
  std::uint64_t overtaken_ = 0;   ///< all before this number are
  std::set<std::uint64_t> kept_;  ///< of which it is known what they say
};

}  // namespace sealwatch
