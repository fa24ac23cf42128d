#pragma once

#include "narrowphase/manifold.h"
#include "solver/law/contact_force.h"
#include "solver/world/page_pool.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace springtower {

/// Pose of the second block of a pair relative to the first: its centre and sides along the edges of the first, m.
using RelativePose = std::array<float, 12>;

/// Force and torque of a contact on block a of its pair when the first of the two fell asleep: the reference for later load
/// changes.
struct SleepLoad {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about the world's origin
  bool operator==(const SleepLoad&) const = default;
};

/// The shape of a contact without the indices of its blocks, which are in the pair table; eight bytes.
struct StoredShape {
  std::int32_t secondRow = -1;  ///< row of points 5 to 8 in their own pages; -1 if no contact of the pair has had so many
  std::int8_t count = 0;
  std::int8_t incidentFace = 0;
  std::int8_t referenceFace = 0;
  bool upperIsB : 1 = false;
  bool slips : 1 = false;
  PointKind kind : 6 = PointKind::penalty;
};

/// A pair of blocks and its phase.
struct PairOfBlocks {
  std::int32_t a;
  std::int32_t b;  ///< -1: the floor
  PairPhase phase;
};

/// The shape of a touching pair's contact, with the indices of its blocks.
inline ManifoldShape shapeOf(const StoredShape& stored, const PairOfBlocks& pair) {
  ManifoldShape shape;
  shape.upper = stored.upperIsB ? pair.b : pair.a;
  shape.lower = stored.upperIsB ? pair.a : pair.b;
  shape.count = stored.count;
  shape.incidentFace = stored.incidentFace;
  shape.referenceFace = stored.referenceFace;
  shape.phase = pair.phase;
  shape.kind = stored.kind;
  shape.slips = stored.slips;
  return shape;
}

/// The contacts of touching pairs, structure of arrays: four points a row, and a second row for points five to eight. Beside the
/// persistent rows lie those of the step, the trial points at the end of an implicit step that is not yet accepted, and copies
/// for running the frame again, made where something is copied. (Trial points outlive the step: where the forces are known, the
/// next step begins with them.)
class ContactPool {
 public:
  /// Bytes of a touching pair with up to four points; of a second row; and what frames and steps add to each.
  static constexpr std::size_t kFirstBytes = sizeof(StoredShape) + sizeof(PlaceRow) + sizeof(PointRow);
  static constexpr std::size_t kSecondBytes = sizeof(PlaceRow) + sizeof(PointRow);
  static constexpr std::size_t kSleepBytes = sizeof(SleepLoad);    ///< more in pages where a block has fallen asleep
  static constexpr std::size_t kPoseBytes = sizeof(RelativePose);  ///< and in those where a manifold has been refreshed
  static constexpr std::size_t kFirstStepBytes = sizeof(PointRow);
  static constexpr std::size_t kWideBytes = sizeof(PairForce);  ///< more in wide islands
  static constexpr std::size_t kSecondStepBytes = sizeof(PointRow);

  /// Takes a contact for a pair, without points. Any thread.
  std::int32_t take();
  /// Returns one to the pool. Not while others take.
  void giveBack(std::int32_t contact);
  /// Makes room for a frame: `most` bounds the number of contacts. `wide`: whether islands sum their forces pair by pair. Not
  /// while others take.
  void reserve(std::size_t most, bool wide);

  /// Stores a manifold in a contact, whose pose becomes unknown. Any thread, one thread a contact.
  void store(std::int32_t contact, const PairOfBlocks& pair, const Manifold& manifold);

  /// Read-only view of a contact. Precondition: its pair touches.
  [[nodiscard]] ContactView view(std::int32_t contact, const PairOfBlocks& pair) const {
    const First& page = first_.page(contact);
    const std::size_t slot = Pool::slot(contact);
    const StoredShape& stored = page.shape[slot];
    ContactView view;
    static_cast<ManifoldShape&>(view) = shapeOf(stored, pair);
    readPatch(page, slot, view);
    view.place[0] = &page.place[slot];
    view.points[0] = &page.points[slot];
    if (stored.count <= static_cast<std::int8_t>(kRowPoints)) return view;
    const Second& more = second_.page(stored.secondRow);
    view.place[1] = &more.place[Pool::slot(stored.secondRow)];
    view.points[1] = &more.points[Pool::slot(stored.secondRow)];
    return view;
  }

  [[nodiscard]] StoredShape& shape(std::int32_t contact) { return first_.page(contact).shape[Pool::slot(contact)]; }
  [[nodiscard]] const StoredShape& shape(std::int32_t contact) const { return first_.page(contact).shape[Pool::slot(contact)]; }

  /// A contact with the rows of its points, now and at the end of an implicit step not yet accepted (trial).
  struct Editable {
    ContactView view;
    PointRows points;
    PointRows trial;
  };
  [[nodiscard]] Editable edit(std::int32_t contact, const PairOfBlocks& pair) {
    First& page = first_.page(contact);
    const std::size_t slot = Pool::slot(contact);
    const StoredShape& stored = page.shape[slot];
    Editable result;
    static_cast<ManifoldShape&>(result.view) = shapeOf(stored, pair);
    readPatch(page, slot, result.view);
    result.view.place[0] = &page.place[slot];
    result.points = {&page.points[slot], nullptr};
    result.trial = {&page.trial[slot], nullptr};
    if (stored.count > static_cast<std::int8_t>(kRowPoints)) {
      Second& more = second_.page(stored.secondRow);
      const std::size_t moreSlot = Pool::slot(stored.secondRow);
      result.view.place[1] = &more.place[moreSlot];
      result.points[1] = &more.points[moreSlot];
      result.trial[1] = &more.trial[moreSlot];
    }
    result.view.points = {result.points[0], result.points[1]};
    return result;
  }

  /// Sets whether all points of a contact slip, and where friction acts on it then. Any thread, one thread a contact.
  void setSlipping(std::int32_t contact, const SlipPatch& patch) {
    First& page = first_.page(contact);
    page.shape[Pool::slot(contact)].slips = true;
    (*page.patch)[Pool::slot(contact)] = patch;
  }
  void setSticking(std::int32_t contact) { shape(contact).slips = false; }

  /// The rows of a contact's points now, and at the end of an implicit step not yet accepted; null past those in use.
  [[nodiscard]] PointRows points(std::int32_t contact) {
    return rows(
        contact, [](auto& page) -> auto& { return page.points; });
  }
  [[nodiscard]] PointRows trial(std::int32_t contact) {
    return rows(
        contact, [](auto& page) -> auto& { return page.trial; });
  }
  [[nodiscard]] ConstPointRows points(std::int32_t contact) const {
    return constRows(
        contact, [](const auto& page) -> const auto& { return page.points; });
  }
  [[nodiscard]] ConstPointRows trial(std::int32_t contact) const {
    return constRows(
        contact, [](const auto& page) -> const auto& { return page.trial; });
  }

  /// Load as one of the blocks fell asleep; zeros where none has. Any thread, one thread a contact.
  [[nodiscard]] SleepLoad sleepLoad(std::int32_t contact) const {
    return first_.page(contact).sleepLoad.read(Pool::slot(contact));
  }
  void setSleepLoad(std::int32_t contact, const SleepLoad& load) {
    first_.page(contact).sleepLoad.write(Pool::slot(contact), load);
  }
  /// Relative pose of the blocks when the manifold was last refreshed; zeros where it was made otherwise. Any thread, one thread
  /// a contact.
  [[nodiscard]] RelativePose pose(std::int32_t contact) const { return first_.page(contact).pose.read(Pool::slot(contact)); }
  void setPose(std::int32_t contact, const RelativePose& pose) { first_.page(contact).pose.write(Pool::slot(contact), pose); }
  /// Forces of the pair, for the sums of a wide island. Precondition: reserved as wide.
  [[nodiscard]] PairForce& pairForce(std::int32_t contact) { return (*first_.page(contact).pairForce)[Pool::slot(contact)]; }

  /// Saves the points as the frame began, from the points now or, once its only step is accepted, from the trial points; and
  /// restores them. Any thread, one thread a contact.
  void savePoints(std::int32_t contact);
  void saveTrial(std::int32_t contact);
  void restorePoints(std::int32_t contact);
  /// Copies the points to the trial points, and back.
  void copyToTrial(std::int32_t contact);
  void copyFromTrial(std::int32_t contact);
  /// Saves shape, places and pose too, before they change in the frame, and restores them.
  void saveShape(std::int32_t contact);
  void restoreShape(std::int32_t contact);

  /// Whether islands sum their forces pair by pair.
  [[nodiscard]] bool isWide() const { return first_.isWide(); }
  /// Returns the memory of all that is saved. Not while frames run.
  void releaseSaved();

  /// Overwrites with NaN what is saved for rollbacks.
  void poisonStartRows();

  [[nodiscard]] std::size_t inUse() const { return first_.rowsInUse(); }
  [[nodiscard]] std::size_t secondRowsInUse() const { return second_.rowsInUse(); }
  [[nodiscard]] std::size_t bytes() const;      ///< of the contacts in use
  [[nodiscard]] std::size_t stepBytes() const;  ///< that frames and steps add to those, with all that is made for copies

 private:
  // Owned by a page beside its rows, and filled anew by frames or steps: not copied, but made by `prepare`.
  template <class T>
  struct Working : std::unique_ptr<T> {
    Working() = default;
    Working(const Working& /*other*/) : std::unique_ptr<T>() {}
    Working& operator=(const Working& /*other*/) { return *this; }
    Working(Working&&) noexcept = default;
    Working& operator=(Working&&) noexcept = default;
    ~Working() = default;
  };

  // The same, allocated at first use, on any thread.
  template <class T>
  class OnDemand {
   public:
    OnDemand() = default;
    OnDemand(const OnDemand& /*other*/) {}
    OnDemand& operator=(const OnDemand& /*other*/) { return *this; }
    ~OnDemand() { release(); }
    T& operator*() {
      T* const there = made_.load(std::memory_order_acquire);
      return there != nullptr ? *there : make();
    }
    [[nodiscard]] T* get() const { return made_.load(std::memory_order_acquire); }
    void release() { delete made_.exchange(nullptr); }

   private:
    T& make() {
      auto made = std::make_unique<T>();
      T* there = nullptr;
      return made_.compare_exchange_strong(there, made.get()) ? *made.release() : *there;  // otherwise another thread was first
    }
    std::atomic<T*> made_{nullptr};
  };

  // A column that is allocated where a row is set to something else than T{}, on any thread. Copied with its page; what a copy
  // is assigned to keeps its memory.
  template <class T>
  class RareColumn {
   public:
    RareColumn() = default;
    RareColumn(const RareColumn& other) { *this = other; }
    RareColumn& operator=(const RareColumn& other) {
      if (this == &other) return *this;
      if (const Column<T>* const theirs = other.rows_.get()) {
        *rows_ = *theirs;
      } else if (Column<T>* const mine = rows_.get()) {
        mine->fill(T{});
      }
      return *this;
    }
    ~RareColumn() = default;
    [[nodiscard]] T read(std::size_t slot) const {
      const Column<T>* const rows = rows_.get();
      return rows != nullptr ? (*rows)[slot] : T{};
    }
    void write(std::size_t slot, const T& value) {
      if (rows_.get() != nullptr || !(value == T{})) (*rows_)[slot] = value;
    }
    [[nodiscard]] bool isMade() const { return rows_.get() != nullptr; }

   private:
    OnDemand<Column<T>> rows_;
  };

  struct FirstStart {
    Column<PointRow> before;
    Column<PlaceRow> placeBefore;
    Column<StoredShape> shapeBefore;
    Column<RelativePose> poseBefore;
  };
  struct SecondStart {
    Column<PointRow> before;
    Column<PlaceRow> placeBefore;
  };
  struct First {
    Column<StoredShape> shape;
    Column<PlaceRow> place;
    Column<PointRow> points;
    Column<PointRow> trial;
    RareColumn<SleepLoad> sleepLoad;
    RareColumn<RelativePose> pose;
    OnDemand<FirstStart> start;
    OnDemand<Column<SlipPatch>> patch;  // of those that slip
    Working<Column<PairForce>> pairForce;
    void prepare(bool wide) {
      if (wide && pairForce == nullptr) pairForce.reset(new Column<PairForce>);
    }
  };
  struct Second {
    Column<PlaceRow> place;
    Column<PointRow> points;
    Column<PointRow> trial;
    OnDemand<SecondStart> start;
    void prepare(bool /*wide*/) {}
  };
  using Pool = PagePool<First>;

  // A copied pool has no patches: they are found anew before the next step.
  static void readPatch(const First& page, std::size_t slot, ManifoldShape& shape) {
    if (!shape.slips) return;
    const Column<SlipPatch>* const patches = page.patch.get();
    if (patches != nullptr) shape.patch = (*patches)[slot];
  }

  template <class Get>
  PointRows rows(std::int32_t contact, const Get& get) {
    First& page = first_.page(contact);
    const StoredShape& stored = page.shape[Pool::slot(contact)];
    PointRows result{&get(page)[Pool::slot(contact)], nullptr};
    if (stored.count > static_cast<std::int8_t>(kRowPoints))
      result[1] = &get(second_.page(stored.secondRow))[Pool::slot(stored.secondRow)];
    return result;
  }

  template <class Get>
  [[nodiscard]] ConstPointRows constRows(std::int32_t contact, const Get& get) const {
    const First& page = first_.page(contact);
    const StoredShape& stored = page.shape[Pool::slot(contact)];
    ConstPointRows result{&get(page)[Pool::slot(contact)], nullptr};
    if (stored.count > static_cast<std::int8_t>(kRowPoints))
      result[1] = &get(second_.page(stored.secondRow))[Pool::slot(stored.secondRow)];
    return result;
  }

  template <class Visit>
  void forRows(std::int32_t contact, const Visit& visit);

  PagePool<First> first_;
  PagePool<Second> second_;
};

}  // namespace springtower
