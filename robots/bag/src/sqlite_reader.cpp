// Files of ROS 2's rosbag2 in SQLite. The tables of all distributions:
//
//     topics(id, name, type, serialization_format, ...)           until Foxy; more columns later
//     messages(id, topic_id, timestamp, data)
//     message_definitions(topic_type, encoding, encoded_message_definition, ...)   since Iron
//
// https://github.com/ros2/rosbag2, rosbag2_storage_sqlite3
#include <fmt/format.h>
#include <sqlite3.h>

#include <filesystem>
#include <map>
#include <string_view>

#include "source.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::bag::sqlite {
namespace {

[[noreturn]] void refuse(const std::string& name, std::string_view why) {
  fail_damaged(name, why, fmt::format("; 'sqlite3 {} .recover | sqlite3 NEW.db3' may help", name));
}

/// The error of the last call.
[[noreturn]] void refuse(const std::string& name, sqlite3* database) {
  const int error = ::sqlite3_errcode(database);
  const std::string why = ::sqlite3_errmsg(database);
  if (error == SQLITE_CANTOPEN || error == SQLITE_READONLY) {
    throw FileError(with_code(Code::no_access,
                              "'{0}' cannot be opened: {1}; copy it, with {0}-wal if there is one, "
                              "to a folder that can be written",
                              name, why));
  }
  refuse(name, why);
}

/// One file that is open for reading.
class Database {
 public:
  Database(const std::string& path, std::string name) : name_(std::move(name)) {
    // `immutable` keeps SQLite from writing to the folder of the file. A recorder that was killed
    // leaves messages in a second file; SQLite merges it, and then has to write.
    std::error_code none;
    const auto log_size = std::filesystem::file_size(path + "-wal", none);
    const bool merges = !none && log_size > 0;
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(path).string()) {
      uri += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02X}", static_cast<int>(c))
                                              : std::string(1, c);
    }
    uri += merges ? "" : "?immutable=1";
    if (merges) {
      FilesRead::note(path + "-wal");
    }
    const int error =
        ::sqlite3_open_v2(uri.c_str(), &database_, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    if (error != SQLITE_OK) {
      const std::unique_ptr<sqlite3, decltype(&::sqlite3_close)> closed(database_,
                                                                        &::sqlite3_close);
      refuse(name_, database_);
    }
    // As SQLite advises for untrusted files.
    ::sqlite3_db_config(database_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    ::sqlite3_db_config(database_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    ::sqlite3_db_config(database_, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  }
  ~Database() { ::sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  sqlite3* get() const { return database_; }
  const std::string& name() const { return name_; }
  [[noreturn]] void fail() const { refuse(name_, database_); }

 private:
  std::string name_;
  sqlite3* database_ = nullptr;
};

class Query {
 public:
  Query(const Database& database, std::string_view text) : database_(database) {
    if (::sqlite3_prepare_v2(database.get(), text.data(), static_cast<int>(text.size()),
                             &statement_, nullptr) != SQLITE_OK) {
      database.fail();
    }
  }
  ~Query() { ::sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  /// Goes to the next row. False: there is none.
  bool next() {
    const int result = ::sqlite3_step(statement_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) {
      database_.fail();
    }
    return result == SQLITE_ROW;
  }
  void restart_with(std::int64_t value) {
    ::sqlite3_reset(statement_);
    ::sqlite3_bind_int64(statement_, 1, value);
  }
  std::int64_t number(int column) const { return ::sqlite3_column_int64(statement_, column); }
  std::string text(int column) const { return std::string(bytes(column)); }
  /// Valid until the next row.
  std::string_view bytes(int column) const {
    const void* const data = ::sqlite3_column_blob(statement_, column);
    const auto size = static_cast<std::size_t>(::sqlite3_column_bytes(statement_, column));
    return data == nullptr ? std::string_view{}
                           : std::string_view(static_cast<const char*>(data), size);
  }

 private:
  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

class SqliteBytes : public Bytes {
 public:
  explicit SqliteBytes(std::shared_ptr<const Database> database)
      : database_(std::move(database)),
        query_(*database_, "SELECT data FROM messages WHERE id=?") {}

  std::span<const std::byte> read(const Place& place) override {
    query_.restart_with(static_cast<std::int64_t>(place.position));
    if (!query_.next()) {
      refuse(database_->name(), "a message was deleted after the file was opened");
    }
    return std::as_bytes(std::span(query_.bytes(0)));
  }

 private:
  std::shared_ptr<const Database> database_;
  Query query_;
};

class SqliteFile : public Source {
 public:
  SqliteFile(const std::string& path, const std::string& name)
      : Source(name), database_(std::make_shared<Database>(path, name)) {
    if (!has_columns("topics", {"id", "name", "type", "serialization_format"}) ||
        !has_columns("messages", {"id", "topic_id", "timestamp", "data"})) {
      throw FileError(with_code(Code::no_access,
                                "'{}' is an SQLite file, but no recording of ROS 2: it has no "
                                "tables 'topics' and 'messages'; write the path of a recording",
                                name));
    }
    read_topics();
    read_places();
  }

  std::unique_ptr<Bytes> bytes() const override { return std::make_unique<SqliteBytes>(database_); }

 private:
  bool has_columns(std::string_view table, std::initializer_list<std::string_view> columns) const {
    for (const std::string_view column : columns) {
      Query query(*database_, fmt::format("SELECT 1 FROM pragma_table_info('{}') WHERE name='{}'",
                                          table, column));
      if (!query.next()) {
        return false;
      }
    }
    return true;
  }

  void read_topics() {
    const bool has_hash = has_columns("topics", {"type_description_hash"});
    std::map<std::string, messages::Schema> schemas;
    if (has_columns("message_definitions",
                    {"topic_type", "encoding", "encoded_message_definition"})) {
      Query query(
          *database_,
          "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
      while (query.next()) {
        schemas[query.text(0)] = {std::string(messages::kRos2), query.text(0), query.text(1),
                                  query.text(2)};
      }
    }
    Query query(*database_, fmt::format("SELECT id, name, type, serialization_format{} FROM topics",
                                        has_hash ? ", type_description_hash" : ""));
    while (query.next()) {
      topics_[query.number(0)] = static_cast<std::uint32_t>(connections_.size());
      Connection& connection = connections_.emplace_back();
      connection.topic = query.text(1);
      connection.type = messages::without_msg(query.text(2));
      connection.encoding = query.text(3);
      connection.version = has_hash ? query.text(4) : "";
      connection.schema = schemas[query.text(2)];
      set_dialect(connection);
    }
  }

  void read_places() {
    // Sorted by time, as rosbag2 plays messages: a recorder with several threads writes rows out of
    // order.
    Query query(*database_, "SELECT id, topic_id, timestamp FROM messages ORDER BY timestamp, id");
    while (query.next()) {
      const auto topic = topics_.find(query.number(1));
      if (topic == topics_.end()) {
        refuse(path_, "a message belongs to no topic");
      }
      if (query.number(2) < 0) {
        refuse(path_, "the time of a message is out of range");
      }
      places_.push_back(
          {query.number(2), topic->second, 0, static_cast<std::uint64_t>(query.number(0))});
    }
    keep_used_connections();
  }

  std::shared_ptr<const Database> database_;
  std::map<std::int64_t, std::uint32_t> topics_;  ///< their connections
};

}  // namespace
}  // namespace spikeloop::bag::sqlite

std::unique_ptr<spikeloop::bag::Source> spikeloop::bag::open_sqlite(const std::string& path,
                                                                    const std::string& name) {
  return std::make_unique<sqlite::SqliteFile>(path, name);
}
