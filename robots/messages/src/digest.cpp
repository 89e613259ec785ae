#include "digest.hpp"

#include <sys/types.h>

#include <md5.h>
#include <sha2.h>

#include <cstdint>

namespace spikeloop::messages {
namespace {

const std::uint8_t* bytes_of(std::string_view text) {
  return reinterpret_cast<const std::uint8_t*>(text.data());
}

}  // namespace

std::string md5_hex(std::string_view text) {
  char hex[MD5_DIGEST_STRING_LENGTH];
  return MD5Data(bytes_of(text), text.size(), hex);
}

std::string sha256_hex(std::string_view text) {
  char hex[SHA256_DIGEST_STRING_LENGTH];
  return SHA256Data(bytes_of(text), text.size(), hex);
}

}  // namespace spikeloop::messages
