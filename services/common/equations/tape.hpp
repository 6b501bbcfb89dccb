// Expressions as a list of instructions over numbered registers: what a simulation evaluates millions of times.
//
//   Tape tape(expressions, {f, df_dx}, fixed);       fixed[k]: variable k keeps its value while registers are used
//   std::vector<double> r = tape.registers();        the first ones are the variables
//   r[k] = ...; tape.prepare(r);                     what depends on fixed variables alone, once
//   r[k] = ...; tape.run(r); tape.result(r, 0);      as often as wanted
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "services/common/equations/expression.hpp"

namespace sealwatch::equations {

class Tape {
 public:
  Tape(const Expressions& expressions, std::span<const Node> results, const std::vector<bool>& fixed);

  [[nodiscard]] const std::vector<double>& registers() const { return registers_; }
  void prepare(std::vector<double>& registers) const { run(once_, registers.data()); }
  void run(std::vector<double>& registers) const { run(always_, registers.data()); }
  [[nodiscard]] double result(const std::vector<double>& registers, std::size_t index) const {
    return registers[results_[index]];
  }
  [[nodiscard]] std::size_t instructions() const { return always_.size(); }

 private:
  struct Instruction {
    Operation operation;
    std::uint32_t to, a, b;
  };
  void run(const std::vector<Instruction>& instructions, double* r) const;

  std::shared_ptr<const std::vector<Table>> tables_;
  std::vector<double> registers_;  ///< variables, then what is computed; constants in place
  std::vector<Instruction> once_, always_;
  std::vector<std::uint32_t> results_;
};

}  // namespace sealwatch::equations
