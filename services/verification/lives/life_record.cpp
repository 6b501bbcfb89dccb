#include "services/verification/lives/life_record.hpp"

#include <bit>
#include <cstring>

namespace sealwatch::verification {
namespace {

constexpr std::string_view kMagic = "SWLIFE2\n";
static_assert(std::endian::native == std::endian::little, "records are little-endian");

std::uint64_t sum_of(std::string_view bytes) {  // FNV-1a
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  return hash;
}

template <class T>
void put(std::string& bytes, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}
  template <class T>
  T take() {
    T value{};
    if (rest_.size() < sizeof value) {
      short_ = true;
      return value;
    }
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  [[nodiscard]] bool at_end() const { return rest_.empty() && !short_; }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  bool short_ = false;
};

template <class Visitor, class Answer>
void visit_numbers(Visitor&& visitor, Answer& answer) {
  for (auto* number : {&answer.rul, &answer.interval_95_low, &answer.interval_95_high, &answer.p10, &answer.p90,
                       &answer.pit, &answer.crps, &answer.mass_within_alpha})
    visitor(*number);
}

RecordedTest take_test(Reader& reader) {
  RecordedTest test;
  test.time_months = reader.take<double>();
  test.condition = reader.take<double>();
  test.usable = reader.take<std::uint8_t>() != 0;
  test.estimate = reader.take<double>();
  test.estimate_std = reader.take<double>();
  return test;
}

RecordedAnswer take_answer(Reader& reader) {
  RecordedAnswer answer;
  answer.state = static_cast<ForecastState>(reader.take<std::uint8_t>());
  visit_numbers([&reader](float& number) { number = reader.take<float>(); }, answer);
  return answer;
}

}  // namespace

std::string to_bytes(const LifeRecord& record) {
  std::string bytes(kMagic);
  put(bytes, record.life);
  put(bytes, record.end_of_life_months);
  put(bytes, static_cast<std::uint8_t>(record.censored));
  put(bytes, static_cast<std::uint32_t>(record.tests.size()));
  put(bytes, static_cast<std::uint32_t>(record.answers.size()));
  for (const RecordedTest& test : record.tests) {
    put(bytes, test.time_months);
    put(bytes, test.condition);
    put(bytes, static_cast<std::uint8_t>(test.usable));
    put(bytes, test.estimate);
    put(bytes, test.estimate_std);
  }
  for (const auto& method : record.answers)
    for (const RecordedAnswer& answer : method) {
      put(bytes, static_cast<std::uint8_t>(answer.state));
      visit_numbers([&bytes](const float& number) { put(bytes, number); }, answer);
    }
  put(bytes, sum_of(bytes));
  return bytes;
}

Result<LifeRecord> life_from_bytes(std::string_view bytes) {
  if (bytes.size() < kMagic.size() + sizeof(std::uint64_t) || !bytes.starts_with(kMagic))
    return fail("is not the record of a life");
  const std::string_view content = bytes.substr(0, bytes.size() - sizeof(std::uint64_t));
  if (Reader(bytes.substr(content.size())).take<std::uint64_t>() != sum_of(content))
    return fail("the record is damaged", "delete it and resume the run");
  Reader reader(content.substr(kMagic.size()));
  LifeRecord record;
  record.life = reader.take<std::uint32_t>();
  record.end_of_life_months = reader.take<double>();
  record.censored = reader.take<std::uint8_t>() != 0;
  const auto tests = reader.take<std::uint32_t>();
  const auto methods = reader.take<std::uint32_t>();
  if (tests > reader.left() || methods > reader.left()) return fail("the record's size is wrong");
  for (std::uint32_t k = 0; k < tests; ++k) record.tests.push_back(take_test(reader));
  record.answers.resize(methods);
  for (auto& method : record.answers)
    for (std::uint32_t k = 0; k < tests; ++k) method.push_back(take_answer(reader));
  if (!reader.at_end()) return fail("the record's size is wrong");
  return record;
}

}  // namespace sealwatch::verification
