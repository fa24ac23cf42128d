#pragma once

#include <cstddef>
#include <new>

namespace springtower::plain {

/// In the place of tbb::cache_aligned_allocator with SPRINGTOWER_PLAIN_THREADS: that one takes memory from oneTBB's own pool, and
/// ThreadSanitizer does not see that what one thread returns to it another may take.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{128};

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}  // of another type, as a container needs it

  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kAlignment)); }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, kAlignment); }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
};

}  // namespace springtower::plain
