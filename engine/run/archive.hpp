#pragma once
// State as bytes and back. A type lists what it keeps once, in `template <class A> void keep(A& a)`, which
// serves both ways. Bytes are the machine's own: a checkpoint goes on where it was made.

#include <array>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace quicksand {

template <class T, class A>
concept Keeps = requires(T& value, A& archive) {
  value.keep(archive);
};

/// Writes, or only counts what it would write.
class Saver {
 public:
  static constexpr bool loading = false;
  std::string bytes;
  bool only_counts = false;
  std::size_t count = 0;  ///< bytes, if it only counts

  template <class... T>
  void operator()(T&... values) {
    (put(values), ...);
  }
  void raw(const void* at, std::size_t size) {
    if (only_counts)
      count += size;
    else
      bytes.append(static_cast<const char*>(at), size);
  }

 private:
  template <class T>
  void put(T& value) {
    if constexpr (Keeps<T, Saver>) {
      value.keep(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<T>, "give it a `keep`");
      raw(&value, sizeof value);
    }
  }
  template <class T, class U>
  void put(std::pair<T, U>& pair) {
    put(pair.first), put(pair.second);
  }
  void put(std::string& text) {
    put_size(text.size());
    raw(text.data(), text.size());
  }
  template <class T, class Allocator>
  void put(std::vector<T, Allocator>& list) {
    put_size(list.size());
    if constexpr (std::is_trivially_copyable_v<T> && !Keeps<T, Saver>)
      raw(list.data(), list.size() * sizeof(T));
    else
      for (T& value : list) put(value);
  }
  template <class V>
  void put(std::map<std::string, V>& map) {
    put_size(map.size());
    for (auto& [name, value] : map) {
      std::string key = name;
      put(key), put(value);
    }
  }
  void put_size(std::size_t size) { raw(&size, sizeof size); }
};

/// Reads what a Saver wrote, in the same order. Throws std::runtime_error when there is less of it.
class Loader {
 public:
  static constexpr bool loading = true;
  explicit Loader(std::string_view bytes) : rest_(bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  void raw(void* at, std::size_t size) {
    need(size);
    if (size > 0) std::memcpy(at, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  bool empty() const { return rest_.empty(); }

 private:
  template <class T>
  void get(T& value) {
    if constexpr (Keeps<T, Loader>) {
      value.keep(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<T>, "give it a `keep`");
      raw(static_cast<void*>(&value), sizeof value);
    }
  }
  template <class T, class U>
  void get(std::pair<T, U>& pair) {
    get(pair.first), get(pair.second);
  }
  void get(std::string& text) {
    text.resize(get_size(1));
    raw(text.data(), text.size());
  }
  template <class T, class Allocator>
  void get(std::vector<T, Allocator>& list) {
    list.resize(get_size(std::is_trivially_copyable_v<T> && !Keeps<T, Loader> ? sizeof(T) : 1));
    if constexpr (std::is_trivially_copyable_v<T> && !Keeps<T, Loader>)
      raw(static_cast<void*>(list.data()), list.size() * sizeof(T));
    else
      for (T& value : list) get(value);
  }
  template <class V>
  void get(std::map<std::string, V>& map) {
    map.clear();
    for (std::size_t left = get_size(1); left > 0; --left) {
      std::string name;
      get(name);
      get(map[name]);
    }
  }
  /// Of a list whose elements take at least so many bytes.
  std::size_t get_size(std::size_t element) {
    std::size_t size = 0;
    raw(&size, sizeof size);
    if (size > rest_.size() / element) need(rest_.size() + 1);
    return size;
  }
  void need(std::size_t size) const {
    if (size > rest_.size()) throw std::runtime_error("the checkpoint ends before the state does");
  }

  std::string_view rest_;
};

}  // namespace quicksand
