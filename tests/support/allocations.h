#pragma once

namespace springtower {

/// How often this thread has called the allocator (malloc and its kin, and with them operator new) since it began. A test program
/// counts when it has allocations.cpp among its sources.
long allocationsOfThisThread();

}  // namespace springtower
