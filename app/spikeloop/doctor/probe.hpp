// One look at one thing of the machine, as data: what to start for it, and how to judge the answer.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "children.hpp"
#include "spikeloop/launch/process_tree.hpp"

namespace spikeloop::app::doctor {

enum class Status {
  ok,
  warning,  ///< can be used, but
  missing   ///< is not there, or is of no use
};

struct Finding {
  Status status = Status::ok;
  std::string text;    ///< version and place, or what is wrong
  std::string remedy;  ///< empty when all is well
};

inline Finding ok(std::string text) {
  return {Status::ok, std::move(text), ""};
}
inline Finding warning(std::string text, std::string remedy) {
  return {Status::warning, std::move(text), std::move(remedy)};
}
inline Finding missing(std::string text, std::string remedy) {
  return {Status::missing, std::move(text), std::move(remedy)};
}

struct Probe {
  std::string name;
  bool needed = false;  ///< by every `spikeloop run`
  std::vector<launch::ProgramStart> starts{};
  /// Of the answers of `starts`, in their order.
  std::function<Finding(const std::vector<Answer>&)> judge;
};

/// A probe that starts nothing.
inline Probe fact(std::string name, bool needed, std::function<Finding()> judge) {
  return {std::move(name), needed, {}, [judge = std::move(judge)](const std::vector<Answer>&) {
            return judge();
          }};
}

/// A probe of one program's answer.
inline Probe answer_of(std::string name, bool needed, launch::ProgramStart start,
                       std::function<Finding(const Answer&)> judge) {
  return {std::move(name),
          needed,
          {std::move(start)},
          [judge = std::move(judge)](const std::vector<Answer>& answers) {
            return judge(answers.front());
          }};
}

/// Where a program is that a job would find; empty: nowhere.
std::string in_path(const std::string& program);

/// How much of it is free in a directory that jobs share memory in.
Finding shared_memory(const std::string& directory);

// All probes, module by module. `scratch`: a directory for what programs leave behind; may be
// empty.
std::vector<Probe> own_probes();
std::vector<Probe> mpi_probes(const std::string& scratch);
std::vector<Probe> plugin_probes();
std::vector<Probe> ros_probes();
std::vector<Probe> simulator_probes();
std::vector<Probe> python_probes();
std::vector<Probe> machine_probes();

}  // namespace spikeloop::app::doctor
