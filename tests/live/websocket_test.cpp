#include "app/live/websocket.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/live/access.hpp"
#include "app/live/http.hpp"

namespace spikeloop::view {
namespace {

constexpr std::size_t kLimit = 1000;

ParsedFrame parsed(std::string bytes) {
  const ParsedFrame result = parse_frame(bytes, kLimit);
  if (result.frame) {
    EXPECT_EQ(result.frame->payload, "Hello");
  }
  return result;
}

TEST(WebSocket, AnswersTheKeyOfTheRfc) {
  EXPECT_EQ(accept_key("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
}

TEST(WebSocket, ReadsTheMaskedFrameOfTheRfc) {  // 5.7
  const std::string frame = "\x81\x85\x37\xfa\x21\x3d\x7f\x9f\x4d\x51\x58";
  for (std::size_t size = 0; size < frame.size(); ++size) {
    const ParsedFrame part = parsed(frame.substr(0, size));
    EXPECT_FALSE(part.frame || part.error) << size;
  }
  const ParsedFrame whole = parsed(frame + "more");
  ASSERT_TRUE(whole.frame);
  EXPECT_TRUE(whole.frame->last);
  EXPECT_EQ(whole.frame->opcode, Opcode::text);
  EXPECT_EQ(whole.frame->size, frame.size());
}

TEST(WebSocket, RejectsFramesThatNoClientMaySend) {
  const std::pair<std::string, CloseCode> frames[] = {
      {std::string("\x81\x05Hello"), CloseCode::protocol_error},        // not masked
      {std::string("\xc1\x80\0\0\0\0", 6), CloseCode::protocol_error},  // a reserved bit
      {std::string("\x83\x80\0\0\0\0", 6), CloseCode::protocol_error},  // an unknown opcode
      {std::string("\x09\x80\0\0\0\0", 6), CloseCode::protocol_error},  // half a ping
      {std::string("\x89\xfe\x01\x00", 4), CloseCode::protocol_error},  // a long ping
      {std::string("\x81\xfe\x03\xe9", 4), CloseCode::too_big},         // 1,001 bytes
      {std::string("\x81\xff") + std::string(8, '\xff'), CloseCode::too_big}};
  for (const auto& [frame, code] : frames) {
    EXPECT_EQ(parsed(frame).error, code) << testing::PrintToString(frame);
  }
}

TEST(WebSocket, WritesHeadersOfAllSizes) {
  EXPECT_EQ(frame_header(Opcode::text, 5), "\x81\x05");
  EXPECT_EQ(frame_header(Opcode::binary, 256), std::string("\x82\x7e\x01\x00", 4));
  EXPECT_EQ(frame_header(Opcode::binary, 65536), std::string("\x82\x7f\0\0\0\0\0\x01\0\0", 10));
}

TEST(Http, ReadsAHead) {
  const auto request =
      parse_head("GET /run/a.csv?x=1&token=abc HTTP/1.1\r\nHost:  b \r\nA: 1\r\na: 2, C");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->path, "/run/a.csv");
  EXPECT_EQ(request->argument("token"), "abc");
  EXPECT_EQ(request->argument("tok"), "");
  EXPECT_EQ(request->header("host"), "b");
  EXPECT_EQ(request->header("a"), "1, 2, C");
  EXPECT_TRUE(request->lists("a", "c"));
  EXPECT_FALSE(request->lists("a", "3"));
}

TEST(Http, RejectsWhatIsNoRequest) {
  for (const char* head :
       {"", "GET", "GET /", "GET / HTTP/1.0", "GET x HTTP/1.1", "G T / HTTP/1.1",
        "GET / HTTP/1.1 x", "GET / HTTP/1.1\r\nno colon", "GET / HTTP/1.1\r\n folded: x",
        "POST / HTTP/1.1\r\nContent-Length: 5", "POST / HTTP/1.1\r\nTransfer-Encoding: chunked"}) {
    EXPECT_FALSE(parse_head(head)) << head;
  }
}

TEST(Access, OnlyPressingStopNeedsNoToken) {
  const auto asks = [](const char* parameters, bool may_control) {
    return stop_request(
        {{"op", "setParameters"}, {"parameters", nlohmann::json::parse(parameters)}}, may_control);
  };
  const char* const press = R"([{"name": "run.stop", "value": true}])";
  const char* const release = R"([{"name": "run.stop", "value": false}])";
  EXPECT_EQ(asks(press, false), true);
  EXPECT_EQ(asks(press, true), true);
  EXPECT_EQ(asks(release, false), std::nullopt);
  EXPECT_EQ(asks(release, true), false);
  for (const char* other : {"7", "{}", "[7]", R"([{"name": "run.stop", "value": 1}])",
                            R"([{"name": 7}])", R"([{"name": "run.pause", "value": true}])"}) {
    EXPECT_EQ(asks(other, true), std::nullopt) << other;
  }
  EXPECT_EQ(stop_request(7, true), std::nullopt);
}

TEST(Access, PagesThatAreFilesNeedTheToken) {
  EXPECT_TRUE(is_allowed_origin("http://LOCALHOST:1", "localhost:1", false));
  // Of a local page: "file://" from Chromium, "null" from Firefox.
  for (const char* other : {"http://localhost:2", "https://app.foxglove.dev", "file://", "null"}) {
    EXPECT_FALSE(is_allowed_origin(other, "localhost:1", false)) << other;
    EXPECT_TRUE(is_allowed_origin(other, "localhost:1", true)) << other;
  }
  EXPECT_TRUE(is_allowed_origin("", "localhost:1", false));
}

}  // namespace
}  // namespace spikeloop::view
