#include "npy_header.hpp"

#include <charconv>

namespace spikeloop::npy {

namespace {

/// Walks over the text; every function returns false where the text is another one.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  bool header(Header& header) {
    if (!take('{')) {
      return false;
    }
    int found = 0;
    while (!take('}')) {
      if (!entry(header)) {
        return false;
      }
      ++found;
      if (!take(',')) {
        if (!take('}')) {
          return false;
        }
        break;
      }
    }
    skip_space();
    return at_ == text_.size() && found == 3 && has_type_ && has_order_ && has_shape_;
  }

 private:
  bool entry(Header& header) {
    std::string key;
    if (!quoted(key) || !take(':')) {
      return false;
    }
    if (key == "descr") {
      has_type_ = true;
      return take('[') ? skip_fields() : quoted(header.type) && !header.type.empty();
    }
    if (key == "fortran_order") {
      has_order_ = true;
      header.by_columns = word("True");
      return header.by_columns || word("False");
    }
    has_shape_ = key == "shape";
    return has_shape_ && numbers(header.shape);
  }

  bool numbers(std::vector<std::uint64_t>& shape) {
    if (!take('(')) {
      return false;
    }
    while (!take(')')) {
      skip_space();
      std::uint64_t number = 0;
      const char* const begin = text_.data() + at_;
      const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), number);
      if (error != std::errc{}) {
        return false;
      }
      at_ += static_cast<std::size_t>(end - begin);
      take('L');  // Python 2 wrote 3L
      shape.push_back(number);
      if (!take(',')) {
        return take(')');
      }
    }
    return true;
  }

  /// The list of named fields, whose "[" has been taken; the lists within do not matter.
  bool skip_fields() {
    int depth = 1;
    while (depth > 0 && at_ < text_.size()) {
      depth += text_[at_] == '[' ? 1 : (text_[at_] == ']' ? -1 : 0);
      ++at_;
    }
    return depth == 0;
  }

  bool quoted(std::string& into) {
    for (const char mark : {'\'', '"'}) {
      if (take(mark)) {
        const auto end = text_.find(mark, at_);
        if (end == std::string_view::npos) {
          return false;
        }
        into = text_.substr(at_, end - at_);
        at_ = end + 1;
        return true;
      }
    }
    return false;
  }

  bool word(std::string_view wanted) {
    skip_space();
    const bool there = text_.substr(at_).starts_with(wanted);
    at_ += there ? wanted.size() : 0;
    return there;
  }

  bool take(char wanted) { return word({&wanted, 1}); }

  void skip_space() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) {
      ++at_;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool has_type_ = false;
  bool has_order_ = false;
  bool has_shape_ = false;
};

}  // namespace

std::optional<Header> parse_header(std::string_view text) {
  Header header;
  return Reader(text).header(header) ? std::optional(header) : std::nullopt;
}

}  // namespace spikeloop::npy
