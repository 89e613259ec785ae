#include "commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <sstream>
#include <vector>

#include "option_values.hpp"
#include "python_package.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/processes/python.hpp"

namespace spikeloop::app::bench_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop bench --quick                       two minutes at most, no simulators: a quick test
  spikeloop bench --out results                 everything; takes hours, Ctrl-C keeps the results
  spikeloop bench --out results --part a --encoders rate --simulators none
  spikeloop bench --out results --part c --ticks 1,50 --steps 12
  spikeloop bench --out results --draw          draws table and figures again
  spikeloop bench --learning --seeds 20         tasks of reinforcement learning

Repeats the measurements of Weidel, Djurfeldt, Duarte & Morrison 2016 (Front. Neuroinform. 10:31):
  a  real-time factor vs. number of encoding neurons, and the largest number in real time
  b  real-time factor vs. firing rate of 50,000 neurons
  c  latency from a laser scan to the resulting command vs. tick, over ROS 1
  d  real-time factor vs. tick and number of neurons
Parts a, b and d play back a laser of 100 beams at 20 Hz inside the job, without ROS. The chain is
scan -> connect -> encoder -> (repeaters in a simulator) -> readout -> low pass, with uniform
weights. All programs start at a barrier and run as fast as possible. Build time does not count.

The folder of --out has results.json, which is updated after every run, and one PNG per part.
Results in it are not measured again, so a stopped bench can be continued.

--learning sweeps what `spikeloop new --environment TASK` prints over the seeds, with and without learning or
with the published learning rate, and prints medians and quartiles. The folder of --out keeps the sweeps.
100 seeds take more than an hour on two cores.

Exit codes: 0 measured, 1 some parts could not be measured (see results.json), 2 an option is
invalid, 3 Python or a package is missing, 4 a file cannot be read or written, 130 Ctrl-C)";

constexpr double kLongest_s = 1e6;

struct List {
  const char* option;
  std::vector<std::string> choices;
  const char* what;
};

// Made in functions: strings may not be made before main.
const List& parts() {
  static const List list{"--part", {"a", "b", "c", "d"}, "part"};
  return list;
}
const List& layouts() {
  static const List list{"--layouts", {"fused", "separate"}, "layout"};
  return list;
}
const List& simulators() {
  static const List list{
      "--simulators", {"none", "builtin", "nest", "neuron", "brian2"}, "simulator"};
  return list;
}
const List& encoders() {
  static const List list{"--encoders", {"rate", "poisson", "nef"}, "encoder"};
  return list;
}
const List& tasks() {
  static const List list{
      "--tasks", {"mountain_car", "frozen_lake", "t_maze", "lane", "water_maze"}, "task"};
  return list;
}

struct BenchArguments {
  std::string parts = fmt::format("{}", fmt::join(bench_command::parts().choices, ","));
  std::string layouts = fmt::format("{}", fmt::join(bench_command::layouts().choices, ","));
  std::string simulators = fmt::format("{}", fmt::join(bench_command::simulators().choices, ","));
  std::string encoders = fmt::format("{}", fmt::join(bench_command::encoders().choices, ","));
  std::string ticks = "1,2,5,10,20,50";
  std::string rates = "1,2,5,10,20,40,100,200,400,800";
  std::string trials = "5";
  std::string steps = "50";
  std::string neurons = "50000";
  std::string most = "16000000";
  std::string duration = "10 s";
  std::string limit;
  std::string out;
  std::string tasks = fmt::format("{}", fmt::join(bench_command::tasks().choices, ","));
  std::string seeds = "20";
  bool learning = false;
  bool quick = false;
  bool draw = false;
  bool again = false;
};

/// What --quick puts in the place of options that are not written.
struct Quick {
  const char* option;
  std::string BenchArguments::*value;
  const char* text;
};
constexpr Quick kQuick[] = {{"--simulators", &BenchArguments::simulators, "none"},
                            {"--ticks", &BenchArguments::ticks, "1,50"},
                            {"--rates", &BenchArguments::rates, "40,800"},
                            {"--trials", &BenchArguments::trials, "1"},
                            {"--steps", &BenchArguments::steps, "3"},
                            {"--most", &BenchArguments::most, "1000000"},
                            {"--duration", &BenchArguments::duration, "1 s"}};

void make_quick(const CLI::App& command, BenchArguments& given) {
  for (const Quick& quick : kQuick) {
    if (command.count(quick.option) == 0) {
      given.*quick.value = quick.text;
    }
  }
}

std::string quick_help() {
  std::vector<std::string> words;
  for (const Quick& quick : kQuick) {
    words.push_back(fmt::format("{} {}", quick.option, quick.text));
  }
  return fmt::format("Two minutes at most, with few points; other defaults: {}",
                     fmt::join(words, ", "));
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    words.push_back(word);
  }
  if (text.empty() || text.back() == ',') {
    words.emplace_back();
  }
  return words;
}

void check_list(const List& list, const std::string& text) {
  for (const std::string& word : words_of(text)) {
    if (std::ranges::find(list.choices, word) == list.choices.end()) {
      const std::string near = word.size() > 1 ? nearest(word, list.choices) : "";
      throw ConfigurationError(
          fmt::format("{}: unknown {} '{}'; {}", list.option, list.what, word,
                      near.empty() ? fmt::format("write some of {}", fmt::join(list.choices, ","))
                                   : fmt::format("did you mean '{}'?", near)));
    }
  }
}

double number(const char* option, const std::string& text, const char* unit, double least,
              double most, const std::string& remedy) {
  try {
    const double value = parse_quantity(text, unit);
    if (value >= least && value <= most) {
      return value;
    }
  } catch (const ConfigurationError&) {
    // Told below.
  }
  throw ConfigurationError(fmt::format("{}: '{}' cannot be; write {}", option, text, remedy));
}

std::string whole(const char* option, const std::string& text, double most) {
  const std::string remedy = fmt::format("a whole number from 1 to {}, as in {} 5",
                                         static_cast<std::int64_t>(most), option);
  const double value = number(option, text, "", 1, most, remedy);
  if (value != static_cast<double>(static_cast<std::int64_t>(value))) {
    throw ConfigurationError(fmt::format("{}: '{}' cannot be; write {}", option, text, remedy));
  }
  return fmt::format("{}", static_cast<std::int64_t>(value));
}

std::string numbers(const char* option, const std::string& text, double least, double most,
                    const std::string& remedy) {
  std::vector<std::string> values;
  for (const std::string& word : words_of(text)) {
    values.push_back(fmt::format("{}", number(option, word, "", least, most, remedy)));
  }
  return fmt::format("{}", fmt::join(values, ","));
}

std::string seconds(const char* option, const std::string& text, const char* remedy) {
  return fmt::format("{}", number(option, text, "s", 0.05, kLongest_s, remedy));
}

std::vector<std::string> checked(const BenchArguments& given) {
  check_list(parts(), given.parts);
  check_list(layouts(), given.layouts);
  check_list(simulators(), given.simulators);
  check_list(encoders(), given.encoders);
  std::vector<std::string> words{
      "--programs=" + own_directory(),
      "--part=" + given.parts,
      "--layouts=" + given.layouts,
      "--simulators=" + given.simulators,
      "--encoders=" + given.encoders,
      "--ticks=" + numbers("--ticks", given.ticks, 0.1, 1000,
                           "ms from 0.1 to 1000, divided by commas, as in --ticks 1,10,50"),
      "--rates=" + numbers("--rates", given.rates, 0.1, 10000,
                           "Hz from 0.1 to 10000, divided by commas, as in --rates 1,40,800"),
      "--trials=" + whole("--trials", given.trials, 1000),
      "--steps=" + whole("--steps", given.steps, 100000),
      "--neurons=" + whole("--neurons", given.neurons, 1 << 24),
      "--most=" + whole("--most", given.most, 1 << 24),
      "--duration=" + seconds("--duration", given.duration,
                              "the simulated seconds of a run, at least 0.05, as in --duration 10"),
      "--out=" + (given.out.empty() ? given.quick ? "bench-quick" : "bench" : given.out)};
  if (!given.limit.empty()) {
    words.push_back("--limit=" + seconds("--limit", given.limit,
                                         "the wall seconds that a run may take, at least 0.05, as "
                                         "in --limit 30"));
  }
  for (const auto& [flag, is_given] :
       {std::pair{"--quick", given.quick}, {"--draw", given.draw}, {"--again", given.again}}) {
    if (is_given) {
      words.emplace_back(flag);
    }
  }
  return words;
}

std::vector<std::string> checked_learning(const BenchArguments& given) {
  check_list(tasks(), given.tasks);
  return {"--learning", "--programs=" + own_directory(), "--tasks=" + given.tasks,
          "--seeds=" + whole("--seeds", given.seeds, 10000),
          "--out=" + (given.out.empty() ? "bench-learning" : given.out)};
}

std::string list_type(const List& list) {
  return fmt::format("LIST:{{{}}}", fmt::join(list.choices, ","));
}

void add_lists(CLI::App& command, BenchArguments& given) {
  const auto add = [&command](const List& list, std::string& text, const char* help) {
    command.add_option(list.option, text, help)->type_name(list_type(list));
  };
  add(parts(), given.parts, "Parts to measure, comma-separated [all]");
  add(layouts(), given.layouts, "Layouts [both]");
  add(simulators(), given.simulators, "Simulators of the repeaters after the encoder [all]");
  add(encoders(), given.encoders, "Encoders of part a [all]; b and d have the rate encoder");
}

void add_numbers(CLI::App& command, BenchArguments& given) {
  command.add_option("--ticks", given.ticks, "Ticks of c and d, ms")
      ->type_name("MS,MS")
      ->capture_default_str();
  command.add_option("--rates", given.rates, "Rates of b, Hz")
      ->type_name("HZ,HZ")
      ->capture_default_str();
  command.add_option("--trials", given.trials, "Runs per point of a, b and d")
      ->type_name("NUMBER")
      ->capture_default_str();
  command.add_option("--steps", given.steps, "Steps of the laser range per point of c")
      ->type_name("NUMBER")
      ->capture_default_str();
  command.add_option("--neurons", given.neurons, "Neurons of b")
      ->type_name("NUMBER")
      ->capture_default_str();
  command.add_option("--most", given.most, "Largest number of neurons in a and d")
      ->type_name("NUMBER")
      ->capture_default_str();
  command.add_option("--duration", given.duration, "Simulated time of a run")
      ->type_name("TIME")
      ->capture_default_str();
  command
      .add_option("--limit", given.limit, "Wall time after which a run is stopped [2 x duration]")
      ->type_name("TIME");
}

/// After all other options, most of which are not for it.
void add_learning(CLI::App& command, BenchArguments& given) {
  const std::vector<CLI::Option*> others = command.get_options();
  CLI::Option* const learning = command.add_flag(
      "--learning", given.learning, "Measure learning in episodes instead of speed and latency");
  for (CLI::Option* const other : others) {
    if (!other->check_lname("out") && !other->check_lname("help")) {
      learning->excludes(other);
    }
  }
  command.add_option(tasks().option, given.tasks, "With --learning: its tasks [all]")
      ->type_name(list_type(tasks()))
      ->needs(learning);
  command.add_option("--seeds", given.seeds, "With --learning: runs of each task")
      ->type_name("NUMBER")
      ->capture_default_str()
      ->needs(learning);
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto given = std::make_shared<BenchArguments>();
  CLI::App* command = app.add_subcommand(
      "bench", "Measure speed and latency as in Weidel et al. 2016, or learning");
  add_lists(*command, *given);
  add_numbers(*command, *given);
  command
      ->add_option(
          "--out", given->out,
          "Folder of results.json and figures, or of sweeps [bench, bench-quick, bench-learning]")
      ->check(named("folder"));
  command->add_flag("--quick", given->quick, quick_help());
  command->add_flag("--again", given->again, "Measure the points in results.json again");
  command->add_flag("--draw", given->draw, "Only draw table and figures of results.json");
  add_learning(*command, *given);
  command->footer(kFooter);
  command->callback([given, command, &action] {
    if (given->quick) {
      make_quick(*command, *given);
    }
    action = [given]() -> int {
      become_python("spikeloop.bench", given->learning ? checked_learning(*given) : checked(*given),
                    "which measures and draws", "python3-matplotlib python3-h5py");
    };
  });
}

}  // namespace spikeloop::app::bench_command
