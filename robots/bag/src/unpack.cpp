#include "unpack.hpp"

#include <bzlib.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <lz4.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "cursor.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::bag {
namespace {

constexpr std::string_view kZstdFrame = "\x28\xB5\x2F\xFD";
constexpr const char* kDamaged = "a chunk cannot be unpacked";

bool is_lz4_frame(std::string_view bytes) {
  constexpr std::uint32_t kFrame = 0x184D2204;
  constexpr std::uint32_t kSkippable = 0x184D2A50;  // and the 15 numbers after it
  std::uint32_t magic = 0;
  if (bytes.size() < sizeof magic) {
    return false;
  }
  std::memcpy(&magic, bytes.data(), sizeof magic);
  return magic == kFrame || (magic & ~std::uint32_t{15}) == kSkippable;
}

void unpack_lz4_frames(std::string_view stored, Buffer& bytes) {
  LZ4F_dctx* made = nullptr;
  LZ4F_createDecompressionContext(&made, LZ4F_VERSION);
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      made, &LZ4F_freeDecompressionContext);
  std::size_t done = 0;
  std::size_t left = 0;  // 0: at the end of a frame
  while (!stored.empty()) {
    std::size_t size = bytes.size() - done;
    std::size_t used = stored.size();
    left =
        LZ4F_decompress(context.get(), bytes.data() + done, &size, stored.data(), &used, nullptr);
    if (LZ4F_isError(left) != 0 || (size == 0 && used == 0)) {
      throw std::runtime_error(kDamaged);
    }
    done += size;
    stored.remove_prefix(used);
  }
  if (left != 0 || done != bytes.size()) {
    throw std::runtime_error(kDamaged);
  }
}

/// Some libraries write the size before a block.
void unpack_lz4_block(std::string_view stored, Buffer& bytes) {
  std::uint32_t size = 0;
  if (stored.size() > sizeof size) {
    std::memcpy(&size, stored.data(), sizeof size);
    stored.remove_prefix(size == bytes.size() ? sizeof size : 0);
  }
  const int done = LZ4_decompress_safe(stored.data(), bytes.data(), static_cast<int>(stored.size()),
                                       static_cast<int>(bytes.size()));
  if (done < 0 || static_cast<std::size_t>(done) != bytes.size()) {
    throw std::runtime_error(kDamaged);
  }
}

[[noreturn]] void cannot_unpack(const std::string& packed, const std::string& folder,
                                std::string_view why) {
  throw FileError(with_code(Code::no_access,
                            "'{0}' cannot be unpacked to the folder {1}: {2}; write  zstd -d {0}  "
                            "and the path of the result, or set TMPDIR to another folder",
                            packed, folder, why));
}

void write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category());
    }
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
}

/// Passes the contents of all frames to `take`. A frame that ends too early is unpacked as far as
/// possible. @returns true if all frames are complete @throws std::runtime_error if it is damaged
template <typename Take>
bool unpack_zstd(std::string_view stored, Take&& take) {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(),
                                                                          &ZSTD_freeDStream);
  ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax,
                         ZSTD_dParam_getBounds(ZSTD_d_windowLogMax).upperBound);
  std::vector<char> part(ZSTD_DStreamOutSize());
  ZSTD_inBuffer in{stored.data(), stored.size(), 0};
  std::size_t left = 0;
  bool full = false;
  while (in.pos < in.size || full) {
    ZSTD_outBuffer out{part.data(), part.size(), 0};
    left = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(left) != 0) {
      throw std::runtime_error(ZSTD_getErrorName(left));
    }
    take(std::string_view(part.data(), out.pos));
    full = out.pos == part.size();
  }
  return left == 0;
}

}  // namespace

Buffer unpack_chunk(std::string_view compression, std::string_view stored, std::uint64_t size) {
  Buffer bytes(size);
  if (compression == "zstd") {
    // Returns the size of all frames.
    if (ZSTD_decompress(bytes.data(), bytes.size(), stored.data(), stored.size()) != size) {
      throw std::runtime_error(kDamaged);
    }
  } else if (compression == "bz2") {
    auto unpacked = static_cast<unsigned>(size);
    // BZ2 does not write to its input.
    if (BZ2_bzBuffToBuffDecompress(bytes.data(), &unpacked, const_cast<char*>(stored.data()),
                                   static_cast<unsigned>(stored.size()), 0, 0) != BZ_OK ||
        unpacked != size) {
      throw std::runtime_error(kDamaged);
    }
  } else if (is_lz4_frame(stored)) {
    unpack_lz4_frames(stored, bytes);
  } else {
    unpack_lz4_block(stored, bytes);
  }
  return bytes;
}

bool is_zstd(std::string_view bytes) {
  return bytes.starts_with(kZstdFrame);
}

std::string unpack_message(std::string_view stored) {
  std::string message;
  const bool is_whole = unpack_zstd(stored, [&](std::string_view part) {
    if (message.size() + part.size() > messages::kLargestMessage) {
      throw std::runtime_error(
          fmt::format("a message has more than {} bytes", messages::kLargestMessage));
    }
    message += part;
  });
  if (!is_whole) {
    throw std::runtime_error("a compressed message is cut off");
  }
  return message;
}

UnpackedFile::UnpackedFile(const std::string& packed) {
  std::error_code none;
  const std::string folder = std::filesystem::temp_directory_path(none).string();
  path_ = folder + "/spikeloop-XXXXXX";
  const int file = ::mkostemp(path_.data(), O_CLOEXEC);
  if (file < 0) {
    cannot_unpack(packed, folder, std::strerror(errno));
  }
  try {
    bool is_empty = true;
    unpack_zstd(Mapping(packed).bytes(), [&](std::string_view part) {
      write_all(file, part);
      is_empty &= part.empty();
    });
    if (is_empty) {
      throw std::runtime_error("it is cut off");
    }
    ::close(file);
  } catch (const std::runtime_error& error) {
    ::close(file);
    ::unlink(path_.c_str());
    if (const auto* const system = dynamic_cast<const std::system_error*>(&error)) {
      cannot_unpack(packed, folder, system->code().message());
    }
    throw FileError(with_code(Code::no_access,
                              "'{}' is damaged: {}; record it again, or leave it out", packed,
                              error.what()));
  }
}

UnpackedFile::~UnpackedFile() {
  ::unlink(path_.c_str());
}

}  // namespace spikeloop::bag
