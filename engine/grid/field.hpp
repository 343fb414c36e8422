#pragma once
// Arrays over the whole lattice that cost only where something happens: their memory comes from the system as
// zeros, page by page, once it is touched. The lattice keeps one plain index, and an empty part of the domain
// takes no memory. After R. Setaluri et al., SPGrid, ACM Trans. Graph. 33 (2014) 205, who use virtual memory
// in this way for sparse grids.

#include <sys/mman.h>

#include <cstddef>
#include <cstring>
#include <new>
#include <utility>
#include <vector>

namespace quicksand {

/// Allocator of zeroed pages. Elements made without arguments are left as the system gave them, so a type may
/// be kept in a Field only if all bits zero is a state that it may be found in.
template <class T>
struct ZeroPages {
  using value_type = T;

  ZeroPages() = default;
  template <class U>
  ZeroPages(const ZeroPages<U>&) {}

  T* allocate(std::size_t n) {
#if defined(QUICKSAND_ADDRESS_SANITIZER)
    // From the heap, so that the sanitizer sees where an array ends.
    void* at = ::operator new (n * sizeof(T), std::align_val_t{alignof(T)});
    std::memset(at, 0, n * sizeof(T));
#else
    void* at = mmap(nullptr, n * sizeof(T), PROT_READ | PROT_WRITE,
                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
#endif
    return static_cast<T*>(at);
  }
  void deallocate(T* at, [[maybe_unused]] std::size_t n) {
#if defined(QUICKSAND_ADDRESS_SANITIZER)
    ::operator delete (at, std::align_val_t{alignof(T)});
#else
    munmap(at, n * sizeof(T));
#endif
  }
  template <class U>
  void construct(U*) {}
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }
  template <class U>
  bool operator==(const ZeroPages<U>&) const {
    return true;
  }
};

/// To be asked for before a field is touched, where most of it will be: large pages, of which one costs as
/// much time to find as a small one. Where little is touched they would fill the empty parts.
template <class T>
void wish_large_pages([[maybe_unused]] std::vector<T, ZeroPages<T>>& field) {
#if !defined(QUICKSAND_ADDRESS_SANITIZER)
  if (!field.empty()) madvise(field.data(), field.size() * sizeof(T), MADV_HUGEPAGE);
#endif
}

/// Make one by its size, `Field<T>(n)`: n zeros. `assign` and copies touch everything.
template <class T>
using Field = std::vector<T, ZeroPages<T>>;

}  // namespace quicksand
