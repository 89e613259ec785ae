// A table of the run folder that grows while the run goes on, read piece by piece.

const POLL_MS = 100;
const IDLE_MS = 2000;

export class GrowingTable {
  /// add(cells): a line, its cells as text. clear(): forget all lines, the file is another one.
  constructor(path, { add, clear }) {
    this.path = path;
    this.add = add;
    this.clear = clear;
    this.generation = 0;
    this.restart();
  }

  restart() {
    this.generation += 1;
    this.position = 0;  // bytes that were read
    this.rest = "";
    this.clear();
  }

  /// `growing()` tells whether there can be something new in the file.
  start(growing) {
    const poll = async () => {
      let wait = POLL_MS;
      try {
        if (growing() && !await this.read()) {
          wait = IDLE_MS;
        }
      } catch {
        // no server: the connection says so
      }
      setTimeout(poll, wait);
    };
    poll();
  }

  /// False if there is no file.
  async read() {
    const { generation } = this;
    // From the last byte that is known: without any the answer would be 416, which browsers report as an error.
    const known = this.position > 0 ? 1 : 0;
    const headers = known ? { Range: `bytes=${this.position - known}-` } : {};
    const answer = await fetch(this.path, { headers, cache: "no-store" });
    if (!answer.ok) {
      return answer.status === 416;
    }
    let bytes = new Uint8Array(await answer.arrayBuffer());
    if (generation !== this.generation) {
      return true;  // of the run before
    }
    if (answer.status === 200 && this.position > 0) {
      this.restart();
    } else {
      bytes = bytes.subarray(known);
    }
    this.position += bytes.length;
    const lines = (this.rest + new TextDecoder().decode(bytes)).split("\n");
    this.rest = lines.pop();
    lines.forEach((line) => this.add(line.split(",")));
    return true;
  }
}
