// Feeds a fuzz target what chance makes of a corpus, without clang:
//     NAME_random SECONDS SEED DICTIONARY CORPUS
// where the target is a LLVMFuzzerTestOneInput(). Every file of the corpus is read once, as it is;
// then mutations of them, for SECONDS of CPU time (0: none). The target runs in a process of its
// own, so that whatever ends it, by itself, a sanitizer or a signal, leaves its last input behind,
// as fuzz-finding in the current directory. Exit code 1 then; else 0, with the number of inputs.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr std::size_t kLongest = 4096;  // bytes of an input
constexpr unsigned kSlow = 60;          // s; an input that takes longer is a finding

/// What the parent sees of the child.
struct Shared {
  std::uint64_t inputs = 0;
  std::size_t size = 0;
  std::uint8_t bytes[kLongest]{};
};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The tokens of a libFuzzer dictionary, lines like  name="bytes\x00".
std::vector<std::string> read_dictionary(const std::string& path) {
  std::vector<std::string> tokens;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const auto begin = line.find('"');
    const auto end = line.rfind('"');
    if (line.starts_with('#') || begin == end) {
      continue;
    }
    std::string token;
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (line[i] == '\\' && line[i + 1] == 'x') {
        token += static_cast<char>(std::stoi(line.substr(i + 2, 2), nullptr, 16));
        i += 3;
      } else {
        i += line[i] == '\\' ? 1 : 0;
        token += line[i];
      }
    }
    tokens.push_back(token);
  }
  return tokens;
}

class Mutator {
 public:
  Mutator(std::vector<std::string> corpus, std::vector<std::string> tokens, std::uint64_t seed)
      : corpus_(std::move(corpus)), tokens_(std::move(tokens)), engine_(seed) {}

  std::string next() {
    std::string text = corpus_[below(corpus_.size())];
    for (std::size_t i = 0; i < 1 + below(6); ++i) {
      change(text);
    }
    text.resize(std::min(text.size(), kLongest));
    return text;
  }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(engine_);
  }

  void change(std::string& text) {
    const std::size_t at = below(text.size() + 1);
    const std::size_t length = below(std::min<std::size_t>(40, text.size() - at) + 1);
    switch (below(7)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(below(text.size() + 1), text.substr(at, length));
        break;
      case 2:
        text.insert(at, tokens_.empty() ? "0" : tokens_[below(tokens_.size())]);
        break;
      case 3: {
        const std::string& other = corpus_[below(corpus_.size())];
        text = text.substr(0, at) + other.substr(below(other.size() + 1));
        break;
      }
      case 4:
        set(text, at, below(256), 1);
        break;
      case 5:  // a length that is a little wrong, or very
        set(text, at & ~std::size_t{3}, below(2) == 0 ? below(20) : 0xffffffffu - below(20), 4);
        break;
      default:
        if (at < text.size()) {
          text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        }
    }
  }

  static void set(std::string& text, std::size_t at, std::size_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes && at + i < text.size(); ++i) {
      text[at + i] = static_cast<char>(value >> (8 * i));
    }
  }

  std::vector<std::string> corpus_;
  std::vector<std::string> tokens_;
  std::mt19937_64 engine_;
};

void feed(Shared& shared, const std::string& input) {
  shared.size = std::min(input.size(), kLongest);
  std::memcpy(shared.bytes, input.data(), shared.size);
  ++shared.inputs;
  alarm(kSlow);
  // A copy of exactly this size: what lies behind it is not the input's.
  const std::vector<std::uint8_t> exact(shared.bytes, shared.bytes + shared.size);
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

int report(const Shared& shared, int status) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    std::printf("%llu inputs, no finding\n", static_cast<unsigned long long>(shared.inputs));
    return 0;
  }
  std::ofstream("fuzz-finding", std::ios::binary)
      .write(reinterpret_cast<const char*>(shared.bytes),
             static_cast<std::streamsize>(shared.size));
  std::fprintf(stderr, "input %llu ended the target; it is kept in fuzz-finding\n",
               static_cast<unsigned long long>(shared.inputs));
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s SECONDS SEED DICTIONARY CORPUS\n", argv[0]);
    return 2;
  }
  std::vector<std::string> corpus;
  for (const auto& entry : std::filesystem::directory_iterator(argv[4])) {
    corpus.push_back(text_of(entry.path()));
  }
  std::ranges::sort(corpus);  // the order of a directory is nobody's
  if (corpus.size() < 10) {
    std::fprintf(stderr, "%s has %zu files; a corpus has at least 10\n", argv[4], corpus.size());
    return 2;
  }
  auto* const shared = static_cast<Shared*>(
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  const pid_t child = fork();
  if (child == 0) {
    for (const std::string& input : corpus) {
      feed(*shared, input);
    }
    Mutator mutator(corpus, read_dictionary(argv[3]), std::strtoull(argv[2], nullptr, 10));
    for (const double end = cpu_seconds() + std::atof(argv[1]); cpu_seconds() < end;) {
      feed(*shared, mutator.next());
    }
    std::exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return report(*shared, status);
}
