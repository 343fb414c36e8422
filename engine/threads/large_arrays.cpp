// Large arrays lie on large pages where the system has them on offer: at a million points small ones cost a
// step a tenth of its time, as the processor does not know their addresses by heart. For every `new` of the
// program, so that containers need not know; sanitizers bring their own. And what is freed goes back: by
// itself the C library puts arrays of up to 32 MB among the small ones once one was freed, and a run that
// writes many frames grows for ever (sloshing on 200 000 points: 443 MB after 70 frames instead of 199).

#include <malloc.h>
#include <sys/mman.h>

#include <cstdlib>
#include <new>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;  ///< bytes
/// Bytes from which on the rest of a last page, half of one on average, does not count.
constexpr std::size_t kLarge = 4 * kPage;

/// Bytes from which on the system gives an array memory of its own.
constexpr int kOwn = 1 << 20;
[[maybe_unused]] const int owns = mallopt(M_MMAP_THRESHOLD, kOwn);

void* allocated(std::size_t bytes) {
  if (bytes < kLarge) return std::malloc(bytes ? bytes : 1);
  void* at = std::aligned_alloc(kPage, (bytes + kPage - 1) / kPage * kPage);
  if (at) madvise(at, bytes / kPage * kPage, MADV_HUGEPAGE);  // a wish: failing is as before
  return at;
}

}  // namespace

void* operator new(std::size_t bytes) {
  if (void* at = allocated(bytes)) return at;
  throw std::bad_alloc();
}
void operator delete(void* at) noexcept { std::free(at); }
void operator delete(void* at, std::size_t) noexcept { std::free(at); }

#endif
