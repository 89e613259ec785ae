// Everything that is wrong with a graph is told at once, and nothing that only follows from it.
#include "spikeloop/core/graph_plan.hpp"
#include "tests/support/fault.hpp"

#include <gmock/gmock.h>

namespace spikeloop {
namespace {

using test::Fault;
using testing::ElementsAre;
using testing::IsEmpty;

NodeClass signal_class() {
  NodeDescription description;
  description.name = "copy";
  description.ports = {{"in", PortKind::signal, Direction::input, {}, ""},
                       {"out", PortKind::signal, Direction::output, WidthRule::same_as(0), ""}};
  return {description, {}};
}

class GraphPlanFaults : public testing::Test {
 protected:
  std::vector<std::string> faults(const std::vector<ConnectionDescription>& connections) {
    GraphDescription graph;
    graph.tick = 1'000'000;
    for (const char* name : {"a", "b", "c"}) {
      graph.nodes.push_back({name, &class_, {}, {}});
    }
    graph.connections = connections;
    std::vector<std::string> told;
    plan(graph, [&](const ConfigurationError& error) { told.emplace_back(error.what()); });
    return told;
  }

  const NodeClass class_ = signal_class();
};

TEST_F(GraphPlanFaults, NoneInARing) {
  EXPECT_THAT(faults({{"a", "b", 2, 1}, {"b", "c"}, {"c", "a"}}), IsEmpty());
}

TEST_F(GraphPlanFaults, AreToldTogether) {
  EXPECT_THAT(faults({{"a", "b", 2}, {"b", "a"}, {"b", "a"}}),
              ElementsAre(Fault("the connection 'b.out -> a.in' ... [SL0304]"),
                          Fault("input 'c.in' ... SENDER.out -> c.in [10] [SL0305]"),
                          Fault("the cycle a -> b -> a has no delay ... 1 tick ... [SL0310]")));
}

TEST_F(GraphPlanFaults, AnInputWithAMisspeltConnectionIsNotSaidToHaveNone) {
  EXPECT_THAT(faults({{"a", "b", 2, 1}, {"b", "a"}, {"b", "cc"}}),
              ElementsAre("unknown node 'cc'; did you mean 'c'? [SL0301]"));
}

TEST_F(GraphPlanFaults, StandAtTheirEndsOfTheConnection) {
  const Location to{"x.yaml", 3, 20};
  const Location from{"x.yaml", 3, 5};
  EXPECT_THAT(faults({{"a.oot", "b", 2, 1, to, from}, {"b", "a"}, {"b", "c.inn", 0, 0, to, from}}),
              ElementsAre("x.yaml:3:5: 'a' has no output port 'oot'; did you mean 'out'? [SL0302]",
                          Fault("x.yaml:3:20: 'c' ... 'inn' ... 'in' ... [SL0302]")));
}

}  // namespace
}  // namespace spikeloop
