// A process that the system gives no file descriptor.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "spikeloop/core/error.hpp"

namespace spikeloop::test {

/// Without file descriptors while it lives.
class NoDescriptors {
 public:
  NoDescriptors() {
    // UBSan looks at the vtable of a type that it has not seen yet through a pipe, and says that
    // the object is none when it cannot open one.
    EXPECT_NE(TransportError("seen").exit_code(), 0);
    getrlimit(RLIMIT_NOFILE, &before_);
    rlimit none = before_;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

}  // namespace spikeloop::test
