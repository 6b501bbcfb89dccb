// The names of a plant that is written as text, and the variables behind them:
//   t; states; inputs; rates of the inputs; parameters; what is added at the sites
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "services/common/equations/formula.hpp"
#include "services/common/equations/text_plant.hpp"

namespace sealwatch::equations {

struct VariablePlaces {
  std::size_t states = 1, inputs = 1, rates = 1, parameters = 1, added = 1, count = 1;
  explicit VariablePlaces(const TextPlant& plant);
  VariablePlaces() = default;
};

class PlantNames final : public Names {
 public:
  /// Faults: names that stand twice, units that are none or are not SI.
  PlantNames(const TextPlant& plant, Expressions& expressions, const Faults& faults);

  [[nodiscard]] Result<Formula> quantity(const std::string& name) override;
  [[nodiscard]] std::optional<Result<Formula>> call(const std::string& name,
                                                    const std::vector<Syntax>& arguments) override;
  [[nodiscard]] std::vector<std::string> functions() const override;

  /// The coherent SI unit of something; a fault, and nothing, where it is no unit.
  [[nodiscard]] std::optional<Dimension> unit_at(const std::string& key, const std::string& unit);
  /// Understands every definition, so that those which nobody uses are checked too.
  void check_definitions();
  [[nodiscard]] const VariablePlaces& places() const { return places_; }

 private:
  struct Definition {
    std::string text;
    std::optional<Formula> meaning;  ///< of one with a fault, which is told once: something of any unit
    bool open = false;               ///< is being understood: met again, it depends on itself
  };
  struct KnownTable {
    std::size_t number = 0;
    std::optional<Dimension> x, y;
  };
  void add(const std::string& key, const std::string& name, const std::string& unit, std::size_t variable);
  void add_name(const std::string& key, const std::string& name);
  void add_table(const TextTable& table);
  void define(const std::string& name);
  [[nodiscard]] std::vector<std::string> names() const;

  const TextPlant& plant_;
  Expressions& expressions_;
  const Faults& faults_;
  VariablePlaces places_;
  std::map<std::string, Formula> known_;
  std::map<std::string, Definition> definitions_;
  std::map<std::string, KnownTable> tables_;
  std::map<std::string, std::string> taken_;  ///< name to key
  std::vector<std::string> open_;             ///< definitions that are being understood
};

}  // namespace sealwatch::equations
