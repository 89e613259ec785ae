// window.spikeloop: numbers for tests (Selenium: return window.spikeloop).
//
// connection       "connecting", "connected" or "lost"
// session          id of the server's run
// framesPerSecond  pictures in the last second; 0 when nothing changes
// simulated_s      newest simulated time
// live, range_s    whether the time axis follows the run; its [from, to]
// spikesDrawn      by output: spikes that were put into its raster
// spikesReceived   by output: spikes that came
// signals          by output: rows that came, width, newest values
// sent             by command node: the newest values that were sent, by field
// pose             {t, x, y, theta} of the robot that is drawn, or null
// world            how it is drawn: {oblique, width, height, view}; view as in camera.js, in pixels of the page
// learning         {episodes, successes, returns} that are shown; weights: by topic {synapses, newest, rows}
// trajectoryRows   rows of the path
// scans, pictures  laser scans that came (at most 64 are kept), pictures that were drawn
// parameters       by name, as the server told them
// stop             what the button shows: "released", "pressed", "sending", "offline", "ended" or "unknown"
// banner           {level, text}
// paused, ended    of the run
// latency          {median, p99, count} in ms, or null
// messages         counts by topic
// lost, dropped    bytes that the server lost, messages that it left out for this page
// leftOut          messages that the page left out
// errors           texts
// memoryBytes      of stored spikes, signals and rasters

export function exposeHook({ model, connection, timePanel, world, pictures, learning, status, controls, trajectory, frames }) {
  const spikes = () => [...model.outputs.values()].filter((each) => each.kind === "spikes");
  const signals = () => [...model.outputs.values()].filter((each) => each.kind !== "spikes");
  const newest = (store) => Array.from({ length: store.head ? store.stored : 0 },
                                       (_, i) => finite(store.value(store.head - 1, i)));
  const describe = ({ store }) => ({ rows: store.head, width: store.width, newest: newest(store) });
  const rasters = () => [...timePanel.rasters.values()];
  window.spikeloop = {
    get connection() { return connection.state; },
    get session() { return model.session ?? null; },
    get framesPerSecond() { return frames.filter((each) => each > performance.now() - 1000).length; },
    get simulated_s() { return model.timeline.newest; },
    get live() { return model.timeline.live; },
    get range_s() { return model.timeline.range; },
    get spikesDrawn() { return byKey(spikes(), (each) => timePanel.rasters.get(each.key)?.drawn ?? 0); },
    get spikesReceived() { return byKey(spikes(), (each) => each.store.head); },
    get signals() { return byKey(signals(), describe); },
    get sent() {
      return Object.fromEntries([...model.sent].map(([node, { fields, store }]) => {
        const values = newest(store);
        return [node, Object.fromEntries(fields.map((field, i) => [field.path, values[i] ?? null]))];
      }));
    },
    get pose() { return world.pose ?? null; },
    get world() {
      const { oblique, surface: { width, height } } = world;
      return { oblique, width, height, view: world.current() };
    },
    get learning() {
      const { ended } = learning, successes = ended.filter((each) => each.success).length;
      const weights = [...model.weights].map(([topic, { synapses, newest, rows }]) =>
        [topic, { synapses, newest: [...newest], rows: rows.length }]);
      return { episodes: ended.length, successes, returns: ended.map((each) => each.total),
               weights: Object.fromEntries(weights) };
    },
    get trajectoryRows() { return trajectory.count; },
    get scans() { return model.scans.length; },
    get pictures() { return pictures.shown; },
    get parameters() { return Object.fromEntries(model.parameters); },
    get stop() { return controls.stop.dataset.state; },
    get banner() { return { level: status.state.level, text: status.state.text }; },
    get paused() { return model.summary().paused; },
    get ended() { return model.summary().ended; },
    get latency() { return status.latency ?? null; },
    get messages() { return { ...model.messages }; },
    get lost() { return model.summary().lost; },
    get dropped() { return model.summary().dropped; },
    get leftOut() { return model.leftOut; },
    get errors() { return [...model.errors]; },
    get memoryBytes() { return rasters().reduce((sum, each) => sum + each.bytes, model.bytes); },
  };
}

function byKey(outputs, value) {
  return Object.fromEntries(outputs.map((each) => [each.key, value(each)]));
}

/// JSON has no NaN.
function finite(value) {
  return Number.isFinite(value) ? value : null;
}
