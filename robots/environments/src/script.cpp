#include "spikeloop/environments/script.hpp"

#include "base.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/python_library.hpp"

namespace spikeloop::environments {
namespace {

/// As NodeError.
class ScriptError : public Error {
 public:
  using Error::Error;
  int exit_code() const override { return 5; }
};

class ScriptEnvironment final : public Environment {
 public:
  explicit ScriptEnvironment(std::unique_ptr<Script> script) : script_(std::move(script)) {}

  const Description& description() const override { return script_->description(); }
  void reset(std::uint64_t seed, std::uint64_t episode) override {
    check(script_->reset(seed, episode, observation_));
  }
  Outcome step(double action) override {
    Outcome outcome;
    check(script_->step(checked_action(description(), action), observation_, outcome));
    return outcome;
  }
  std::span<const double> observation() const override { return observation_; }

 private:
  void check(const std::string& error) const {
    if (!error.empty()) {
      throw ScriptError(
          with_code(Code::node_failed, "environment '{}': {}", description().name, error));
    }
  }

  std::unique_ptr<Script> script_;
  std::vector<double> observation_;
};

}  // namespace

std::unique_ptr<Environment> make_script(const std::string& source) {
  const std::string what = "environment '" + source + "'";
  require_code_may_run(what);
  const auto make = reinterpret_cast<MakeScript>(python_function(kMakeScript, what));
  std::string error;
  std::unique_ptr<Script> script(make(source, python_host(), error));
  if (script == nullptr) {
    throw ConfigurationError(with_code(Code::plug_in, "{}: {}", what, error));
  }
  auto environment = std::make_unique<ScriptEnvironment>(std::move(script));
  environment->reset(0, 0);
  return environment;
}

}  // namespace spikeloop::environments
