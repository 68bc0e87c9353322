// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded by scripts/contention: counts how often each lock is taken, how long threads wait for it and how
// long they hold it, by the place in the program that takes it. Seen are the mutexes of pthread, which
// std::mutex is made of, and the lock of the HDF5 library (1.10 and 1.14), which is a counter below a mutex:
// whoever enters the library takes and gives back the mutex, and signals when it leaves. Not seen: locks
// inside malloc and TBB, which spin or are of the kernel.
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <dlfcn.h>
#include <pthread.h>

namespace {

using Nanoseconds = std::int64_t;

Nanoseconds now() {
  timespec time = {};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * Nanoseconds{1'000'000'000} + time.tv_nsec;
}

// All that code at one address did; zero-initialised, since locks are taken before constructors run.
struct Place {
  std::atomic<void*> address;
  std::atomic<std::int64_t> taken, waited_for;
  std::atomic<Nanoseconds> wait, hold;
};
constexpr std::size_t kPlaces = 4096;
std::array<Place, kPlaces> places;
Place hdf5;

struct Held {
  pthread_mutex_t* mutex;
  Place* place;
  Nanoseconds since;
};
constexpr std::size_t kMostHeld = 64;
thread_local std::array<Held, kMostHeld> held;
thread_local std::size_t n_held = 0;
thread_local Nanoseconds in_hdf5_since = 0;  // 0: outside

// A full table shares its last place.
Place& place_of(void* address) {
  for (std::size_t i = (reinterpret_cast<std::uintptr_t>(address) >> 2U) % kPlaces, n = 0;;
       i = (i + 1) % kPlaces, ++n) {
    void* taken = nullptr;
    if (n == kPlaces - 1 || places[i].address.compare_exchange_strong(taken, address) || taken == address)
      return places[i];
  }
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

bool is_in(void* address, const char* library) {
  Dl_info info = {};
  return ::dladdr(address, &info) != 0 && info.dli_fname != nullptr &&
         std::strstr(info.dli_fname, library) != nullptr;
}

// The library's code lies between two addresses, which are looked up once.
bool is_hdf5(void* address) {
  static std::atomic<void*> low = nullptr, high = nullptr;
  if (address >= low && address <= high && low != nullptr) return true;
  thread_local void* known_other = nullptr;
  if (address == known_other || !is_in(address, "libhdf5")) {
    known_other = address;
    return false;
  }
  if (low == nullptr || address < low) low = address;
  if (address > high) high = address;
  return true;
}

void begin_hold(pthread_mutex_t* mutex, Place& place) {
  if (n_held < kMostHeld) held[n_held++] = {mutex, &place, now()};
}

void end_hold(pthread_mutex_t* mutex) {
  for (std::size_t i = n_held; i-- > 0;)
    if (held[i].mutex == mutex) {
      held[i].place->hold += now() - held[i].since;
      held[i] = held[--n_held];
      return;
    }
}

void wait_of_hdf5(Nanoseconds since) {
  ++hdf5.waited_for;
  hdf5.wait += now() - since;
}

struct Report {
  ~Report() {
    const char* path = std::getenv("SALBENCH_LOCK_TIMES");
    std::FILE* file = path == nullptr ? nullptr : std::fopen(path, "w");
    if (file == nullptr) return;
    const auto line = [file](const Place& place, const char* object, std::uintptr_t offset) {
      std::fprintf(file, "%s\t%lx\t%ld\t%ld\t%ld\t%ld\n", object, static_cast<unsigned long>(offset),
                   place.taken.load(), place.waited_for.load(), place.wait.load(), place.hold.load());
    };
    for (const Place& place : places) {
      Dl_info info = {};
      void* address = place.address;
      if (address == nullptr || ::dladdr(address, &info) == 0 || place.taken == 0) continue;
      line(place, info.dli_fname,
           reinterpret_cast<std::uintptr_t>(address) - reinterpret_cast<std::uintptr_t>(info.dli_fbase));
    }
    line(hdf5, "the HDF5 library's own", 0);
    std::fclose(file);
  }
} report;

}  // namespace

extern "C" {

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static const auto lock = next<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  static const auto try_lock = next<int (*)(pthread_mutex_t*)>("pthread_mutex_trylock");
  void* caller = __builtin_return_address(0);
  if (is_hdf5(caller)) {
    if (try_lock(mutex) == 0) return 0;
    const Nanoseconds since = now();
    const int result = lock(mutex);
    wait_of_hdf5(since);
    return result;
  }
  Place& place = place_of(caller);
  ++place.taken;
  if (try_lock(mutex) == 0) {
    begin_hold(mutex, place);
    return 0;
  }
  const Nanoseconds since = now();
  const int result = lock(mutex);
  ++place.waited_for;
  place.wait += now() - since;
  begin_hold(mutex, place);
  return result;
}

int pthread_mutex_unlock(pthread_mutex_t* mutex) noexcept {
  static const auto unlock = next<int (*)(pthread_mutex_t*)>("pthread_mutex_unlock");
  if (!is_hdf5(__builtin_return_address(0))) {
    end_hold(mutex);
  } else if (in_hdf5_since == 0) {
    in_hdf5_since = now();
    ++hdf5.taken;
  }
  return unlock(mutex);
}

int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static const auto wait = next<int (*)(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
  void* caller = __builtin_return_address(0);
  const Nanoseconds since = now();
  if (is_hdf5(caller)) {
    const int result = wait(condition, mutex);
    wait_of_hdf5(since);
    return result;
  }
  end_hold(mutex);
  const int result = wait(condition, mutex);
  begin_hold(mutex, place_of(caller));
  return result;
}

int pthread_cond_signal(pthread_cond_t* condition) noexcept {
  static const auto signal = next<int (*)(pthread_cond_t*)>("pthread_cond_signal");
  if (in_hdf5_since != 0 && is_hdf5(__builtin_return_address(0))) {
    hdf5.hold += now() - in_hdf5_since;
    in_hdf5_since = 0;
  }
  return signal(condition);
}

}  // extern "C"
