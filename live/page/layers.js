// Places the nodes of an experiment in layers: data flow from left to right, feedback goes back.

/// Links between nodes: [{from, to, connections}], each pair of nodes once.
function links(resolved) {
  const found = new Map();
  for (const connection of resolved?.connections ?? []) {
    const [from, to] = [connection.from, connection.to].map((port) => port.slice(0, port.lastIndexOf(".")));
    const key = `${from}\n${to}`;
    if (!found.has(key)) {
      found.set(key, { from, to, connections: [], via: [] });
    }
    found.get(key).connections.push(connection);
  }
  return [...found.values()];
}

/// Layer of every node: the longest way to it from a node without inputs. Links that close a loop are marked
/// `back` and do not count.
function layersOf(names, edges) {
  const state = new Map(), outgoing = new Map(names.map((name) => [name, []]));
  edges.forEach((edge) => outgoing.get(edge.from)?.push(edge));
  const order = [];
  const visit = (name) => {
    state.set(name, 1);
    for (const edge of outgoing.get(name)) {
      edge.back = state.get(edge.to) === 1;
      if (!state.has(edge.to)) {
        visit(edge.to);
      }
    }
    state.set(name, 2);
    order.unshift(name);
  };
  const entered = new Set(edges.map((edge) => edge.to));
  [...names].sort((a, b) => entered.has(a) - entered.has(b)).forEach((name) => state.has(name) || visit(name));
  const layer = new Map(names.map((name) => [name, 0]));
  const forward = (name) => outgoing.get(name).filter((edge) => !edge.back);
  for (const name of order) {
    forward(name).forEach(({ to }) => layer.set(to, Math.max(layer.get(to), layer.get(name) + 1)));
  }
  // A source stands just before what it feeds, not far to the left.
  for (const name of [...order].reverse()) {
    if (!entered.has(name) && forward(name).length) {
      layer.set(name, Math.min(...forward(name).map(({ to }) => layer.get(to))) - 1);
    }
  }
  return layer;
}

/// Places on the way of links that pass layers; their names are no names of nodes.
function addPassages(layers, edges, layer) {
  for (const edge of edges.filter((each) => !each.back)) {
    for (let at = layer.get(edge.from) + 1; at < layer.get(edge.to); ++at) {
      const name = `${edge.from}\n${edge.to}\n${at}`;
      layers[at].push(name);
      edge.via.push(name);
    }
  }
}

/// Each place at the mean of its neighbours, a few times to and fro: few crossings.
function sort(layers, edges) {
  const near = new Map();  // neighbours in the layer before, and in the one behind
  const join = (from, to) => {
    near.set(to, [[...(near.get(to)?.[0] ?? []), from], near.get(to)?.[1] ?? []]);
    near.set(from, [near.get(from)?.[0] ?? [], [...(near.get(from)?.[1] ?? []), to]]);
  };
  for (const { from, to, via, back } of edges) {
    const way = back ? [] : [from, ...via, to];
    way.slice(1).forEach((name, i) => join(way[i], name));
  }
  const place = new Map();
  const note = () => layers.forEach((each) => each.forEach((name, i) => place.set(name, i - (each.length - 1) / 2)));
  note();
  for (let sweep = 0; sweep < 8; ++sweep) {
    for (const each of sweep % 2 ? [...layers].reverse() : layers) {
      const mean = new Map(each.map((name) => {
        const found = (near.get(name)?.[sweep % 2] ?? []).map((other) => place.get(other));
        return [name, found.length ? found.reduce((a, b) => a + b, 0) / found.length : place.get(name)];
      }));
      each.sort((a, b) => mean.get(a) - mean.get(b));
      note();
    }
  }
}

/// {layers: [[name]], edges, isNode}: what stands in each layer from top to bottom. An edge has `back`, and `via`,
/// the names of its places in the layers that it passes.
export function arrange(resolved) {
  const edges = links(resolved);
  const names = [...new Set([...Object.keys(resolved?.nodes ?? {}), ...edges.flatMap((edge) => [edge.from, edge.to])])];
  const layer = layersOf(names, edges);
  const layers = Array.from({ length: Math.max(-1, ...layer.values()) + 1 }, () => []);
  names.forEach((name) => layers[layer.get(name)].push(name));
  addPassages(layers, edges, layer);
  sort(layers, edges);
  const known = new Set(names);
  return { layers: layers.filter((each) => each.length), edges, isNode: (name) => known.has(name) };
}

/// Position of every node in the order of the data's way.
export function ranks(resolved) {
  const { layers, isNode } = arrange(resolved);
  return new Map(layers.flat().filter(isNode).map((name, i) => [name, i]));
}
