#include "spikeloop/process/process.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "gathering.hpp"
#include "process_impl.hpp"
#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/connection_faults.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/process/music_main.hpp"

namespace spikeloop::music {
namespace {

const char* side(Direction direction) {
  return direction == Direction::input ? "an input" : "an output";
}

// What MUSIC itself reads in a section.
constexpr const char* kMusicKeys[] = {"np", "binary", "args", "wd", "timebase"};
// What older programs read and these have no use for.
constexpr const char* kOlderKeys[] = {"verbose"};

}  // namespace

Process::Process(int& argc, char**& argv, const CommonDefaults& defaults)
    : impl_(std::make_unique<Impl>()) {
  impl_->label = section_label(argc, argv);
  impl_->file = JobFile::find(argc, argv);
  impl_->launched = started_by_music(argc, argv);
  impl_->defaults = defaults;
  // MUSIC's launcher starts us as `music FILE`, and Setup then writes the key `binary` there: which
  // may be a script of the user's that has become us.
  const std::string called = argc > 0 ? basename_of(argv[0]) : "";
  mend_music_config();
  int provided = MPI_THREAD_SINGLE;
  impl_->setup = new MUSIC::Setup(argc, argv, MPI_THREAD_FUNNELED, &provided);
  const std::string written = argc > 0 ? basename_of(argv[0]) : impl_->label;
  impl_->program = called.empty() || called == "music" ? written : called;
  const MPI_Comm own = impl_->setup->communicator();
  impl_->ranks.communicator = own;
  MPI_Comm_rank(own, &impl_->ranks.rank);
  MPI_Comm_size(own, &impl_->ranks.count);
  impl_->announce();
  if (impl_->ranks.rank > 0) {
    log::set_sink([](log::Level, std::string_view) {});
  }
  if (impl_->launched) {
    impl_->check_processes();
  }
}

Process::Process(const SectionCheck& section, const CommonDefaults& defaults)
    : impl_(std::make_unique<Impl>()) {
  impl_->take_section(section.file, section.label, defaults);
  impl_->checking = impl_->launched = true;
  impl_->check_processes();
}

Process::Process(const SimulatorsMusic& section, const CommonDefaults& defaults)
    : impl_(std::make_unique<Impl>()) {
  impl_->take_section(section.file, section.label, defaults);
  impl_->launched = true;
  impl_->announce();
  impl_->check_processes();
}

Process::Process(const SectionAlone& section, const CommonDefaults& defaults)
    : impl_(std::make_unique<Impl>()) {
  impl_->take_section(section.file, section.label, defaults);
  impl_->announce();
}

Process::~Process() = default;

const std::string& Process::label() const {
  return impl_->label;
}
const std::string& Process::program() const {
  return impl_->program;
}
bool Process::checking() const {
  return impl_->checking;
}
bool Process::launched() const {
  return impl_->launched;
}
Share Process::share() const {
  return impl_->ranks.share();
}
NodeClass Process::gathering(PortKind kind) const {
  return gathering_class(kind, impl_->ranks);
}
int Process::communicator() const {
  return MPI_Comm_c2f(impl_->ranks.communicator);
}
void Process::let_the_first_speak() const {
  if (impl_->ranks.rank > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(impl_->running ? 200 : 1000));
  }
}
std::string Process::file_directory() const {
  return impl_->file.directory();
}

void Process::set_defaults(const CommonDefaults& defaults) {
  if (impl_->common) {
    throw std::logic_error("set_defaults() after common()");
  }
  impl_->defaults = defaults;
}

const CommonKeys& Process::common() const {
  if (!impl_->common) {
    std::vector<std::string> programs = impl_->file.programs();
    programs.push_back(impl_->program);  // all that is known when the file was not found
    impl_->common =
        parse_common_keys(written(names_of(common_parameters())), impl_->defaults, programs);
    impl_->check_recordable(impl_->common->record);
  }
  return *impl_->common;
}

WrittenValues Process::written(const std::vector<std::string>& names) const {
  WrittenValues values;
  for (const auto& name : names) {
    impl_->asked.insert(name);
    auto text = impl_->key_text(name);
    if (const char* earlier = earlier_key(name); earlier != nullptr && !text) {
      impl_->asked.insert(earlier);
      text = impl_->key_text(earlier);
    }
    if (text) {
      values[name] = {std::move(*text), impl_->file.where(impl_->label, name)};
    }
  }
  return values;
}

Parameters Process::read(const std::vector<ParameterDescription>& declared,
                         const WeightLoader& load_weights) const {
  return resolve(declared, written(names_of(declared)), load_weights);
}

void Process::declare_ports(const std::vector<std::string>& names) const {
  impl_->check_port_names(names);
}

bool Process::connected_input(const std::string& port, PortKind) const {
  return impl_->is_connected(port);
}
bool Process::connected_output(const std::string& port, PortKind) const {
  return impl_->is_connected(port);
}

std::uint32_t Process::width(const std::string& port) const {
  const auto use = impl_->file.port(impl_->label, port);
  return impl_->checked_width(port, use ? use->direction : Direction::input);
}

Location Process::where(const std::string& port) const {
  const auto use = impl_->file.port(impl_->label, port);
  return use ? use->connection->where : Location{};
}

Location Process::where_key(const std::string& key) const {
  return impl_->file.where(impl_->label, key);
}

Location Process::where() const {
  return impl_->file.section_where(impl_->label);
}

std::unique_ptr<Source> Process::signal_input(const std::string& port,
                                              std::optional<int> delay_ticks) {
  const auto width = impl_->checked_width(port, Direction::input);
  impl_->served.insert(port);
  const EndpointPort end{port, PortKind::signal, width};
  const TimeNs delay = delay_ticks.value_or(common().signal_delay) * common().music_timestep;
  return impl_->without_setup
             ? make_idle_source(end)
             : make_signal_source(impl_->open_setup(), impl_->name_in_file(port), end, delay);
}

std::unique_ptr<Source> Process::spike_input(const std::string& port) {
  const auto width = impl_->checked_width(port, Direction::input);
  impl_->served.insert(port);
  const EndpointPort end{port, PortKind::spikes, width};
  return impl_->without_setup ? make_idle_source(end)
                              : make_spike_source(impl_->open_setup(), end, common().accept_latency,
                                                  common().spike_delay);
}

std::unique_ptr<Sink> Process::signal_output(const std::string& port) {
  const auto width = impl_->checked_width(port, Direction::output);
  impl_->served.insert(port);
  const EndpointPort end{port, PortKind::signal, width};
  return impl_->without_setup
             ? make_idle_sink(end)
             : make_signal_sink(impl_->open_setup(), impl_->name_in_file(port), end, impl_->ranks);
}

std::unique_ptr<Sink> Process::spike_output(const std::string& port) {
  const auto width = impl_->checked_width(port, Direction::output);
  impl_->served.insert(port);
  const EndpointPort end{port, PortKind::spikes, width};
  return impl_->without_setup
             ? make_idle_sink(end)
             : make_spike_sink(impl_->open_setup(), end, common().stamp_guard, impl_->ranks);
}

void Process::attach_recorders(GraphDescription& description) {
  if (common().record && !impl_->checking && impl_->ranks.rank == 0) {
    impl_->recording = music::attach_recorders(description, impl_->label);
  }
}

std::function<void(TimeNs, double)> Process::value_recorder(const std::string& stream,
                                                            const std::string& unit) {
  return impl_->recording == nullptr ? nullptr : impl_->recording->value_writer(stream, unit);
}

void Process::enter(status::Phase phase) const {
  impl_->heartbeat->enter(phase);
}

void Process::say_begun() const {
  impl_->status->first_tick();
}

void Process::check() const {
  impl_->check_ports();
  impl_->check_keys(common().strict);
}

void Process::Impl::take_section(const std::string& path, const std::string& name,
                                 const CommonDefaults& with) {
  label = name;
  file = JobFile::read(path);
  defaults = with;
  program = basename_of(file.key(label, "binary").value_or(""));
  ranks.count = file.processes(label);
  without_setup = true;
}

void Process::Impl::announce() {
  status.emplace(label);
  if (ranks.rank > 0) {
    status->silence();
  }
  status->started();
  heartbeat.emplace(*status);
  on_termination.emplace([this] { status->terminated(); });
}

MUSIC::Setup& Process::Impl::open_setup() const {
  if (setup == nullptr) {
    throw std::logic_error("keys and ports can only be asked for before run()");
  }
  return *setup;
}

std::optional<std::string> Process::Impl::key_text(const std::string& name) const {
  if (without_setup) {
    return file.key(label, name);
  }
  std::string text;
  return open_setup().config(name, &text) ? std::optional(text) : std::nullopt;
}

bool Process::Impl::is_connected(const std::string& port) {
  return without_setup ? file.port(label, port).has_value()
                       : probe(name_in_file(port)).isConnected();
}

std::string Process::Impl::name_in_file(const std::string& port) {
  const char* earlier = earlier_port(program, port);
  const bool as_before =
      earlier != nullptr && !probe(port).isConnected() && probe(earlier).isConnected();
  return as_before ? earlier : port;
}

std::optional<int> Process::Impl::connection_width(const std::string& port) {
  if (without_setup) {
    const auto use = file.port(label, port);
    const auto width = use ? use->connection->width : std::nullopt;
    return width ? std::optional(static_cast<int>(*width)) : std::nullopt;
  }
  MUSIC::Port& port_in_file = probe(name_in_file(port));
  return port_in_file.hasWidth() ? std::optional(port_in_file.width()) : std::nullopt;
}

void Process::Impl::check_processes() const {
  if (ranks.count != 1 && !defaults.many_processes) {
    throw ConfigurationError(
        file.where(label, "np"),
        with_code(Code::music_job,
                  "np={0} asks for {0} processes, but {1} runs in one; write  np=1", ranks.count,
                  program));
  }
}

MUSIC::Port& Process::Impl::probe(const std::string& port) {
  auto& found = probes[port];
  if (found == nullptr) {
    found = open_setup().publishEventInput(port);
  }
  return *found;
}

std::string Process::Impl::example(const std::string& port, Direction direction,
                                   const char* width) const {
  const std::string end = fmt::format("{}.{}", label, port);
  return direction == Direction::input ? fmt::format("SENDER.out -> {} [{}]", end, width)
                                       : fmt::format("{} -> RECEIVER.in [{}]", end, width);
}

void Process::Impl::check_recordable(bool record) const {
  if (record && label.find('/') != std::string::npos) {
    throw ConfigurationError(
        file.where(label, "record"),
        with_code(Code::music_job,
                  "the section '{}' cannot be recorded: its file would be {}.h5; write a label "
                  "without '/'",
                  label, label));
  }
}

std::uint32_t Process::Impl::checked_width(const std::string& port, Direction direction) {
  const auto use = file.port(label, port);
  const Location where = use ? use->connection->where : Location{};
  if (!is_connected(port)) {
    throw ConfigurationError(with_code(Code::not_connected,
                                       "port '{}.{}' is not connected; write  {}", label, port,
                                       example(port, direction, "WIDTH")));
  }
  if (use && use->direction != direction) {
    throw ConfigurationError(
        where,
        with_code(Code::music_job, "'{}.{}' is {}, but the file uses it as {}; write  {}", label,
                  port, side(direction), side(use->direction), example(port, direction, "WIDTH")));
  }
  const auto width = connection_width(port);
  if (width && *width > static_cast<int>(kMaximumChannels)) {
    throw ConfigurationError(
        where, with_code(Code::unknown_width,
                         "the connection of '{}.{}' has the width {}; write at most {}", label,
                         port, *width, kMaximumChannels));
  }
  if (!width) {
    const std::string line =
        use ? describe(*use->connection) + " [100]" : example(port, direction, "100");
    throw ConfigurationError(
        where, with_code(Code::unknown_width,
                         "the connection {} '{}.{}' has no width; write  {}  for 100 channels",
                         direction == Direction::input ? "to" : "from", label, port, line));
  }
  if (*width < 1) {
    throw ConfigurationError(
        where, with_code(Code::unknown_width,
                         "the connection of '{}.{}' has the width {}; write the number of its "
                         "channels, at least 1",
                         label, port, *width));
  }
  return static_cast<std::uint32_t>(*width);
}

void Process::Impl::check_port_names(const std::vector<std::string>& names) const {
  for (const auto& use : file.ports(label)) {
    if (std::find(names.begin(), names.end(), use.port) == names.end()) {
      throw ConfigurationError(use.connection->where,
                               unknown_port(label, use.direction, use.port, names));
    }
  }
}

void Process::Impl::check_ports() const {
  if (!launched) {
    return;
  }
  check_port_names({served.begin(), served.end()});
  if (served.empty()) {
    throw ConfigurationError(with_code(
        Code::not_connected,
        "no port of '{}' is connected, and MUSIC would wait forever; connect one, or leave the "
        "section out",
        label));
  }
}

void Process::Impl::check_arguments(bool strict) const {
  const auto arguments = file.key(label, "args");
  if (defaults.takes_arguments || !arguments || arguments->empty()) {
    return;
  }
  const std::string message = with_code(
      Code::music_job, "args={} is for {}, whose parameters are keys of the section; leave it out",
      *arguments, program);
  if (strict) {
    throw ConfigurationError(file.where(label, "args"), message);
  }
  const std::string place = file.where(label, "args").text();
  log::warning("{}{}{}", place, place.empty() ? "" : ": ", lengthened(message, "; it is ignored"));
}

void Process::Impl::check_keys(bool strict) {
  check_arguments(strict);
  std::set<std::string> known = asked;
  for (const char* key : kMusicKeys) {
    known.insert(key);
  }
  for (const char* key : kOlderKeys) {
    known.insert(key);
  }
  const std::vector<std::string> names(known.begin(), known.end());
  for (const auto& key : file.own_keys(label)) {
    if (known.contains(key)) {
      continue;
    }
    const std::string message =
        with_code(Code::unknown_key, "unknown key '{}'{}", key, did_you_mean(key, names));
    if (strict) {
      throw ConfigurationError(file.where(label, key), message);
    }
    const std::string place = file.where(label, key).text();
    log::warning("{}{}{}", place, place.empty() ? "" : ": ",
                 lengthened(message, "; it is ignored"));
  }
}

}  // namespace spikeloop::music
