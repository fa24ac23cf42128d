#include "solver/world/contact_pool.h"

#include "core/tuning.h"

#include <cstring>

namespace springtower {

std::int32_t ContactPool::take() {
  const std::int32_t contact = first_.take();
  First& page = first_.page(contact);
  page.shape[Pool::slot(contact)] = StoredShape{};
  page.sleepLoad[Pool::slot(contact)] = SleepLoad{};
  page.pose[Pool::slot(contact)] = RelativePose{};
  return contact;
}

void ContactPool::giveBack(std::int32_t contact) {
  const std::int32_t second = shape(contact).secondRow;
  if (second >= 0) second_.giveBack(second);
  first_.giveBack(contact);
}

void ContactPool::reserve(std::size_t most, bool wide) {
  wide_ = wide_ || wide;
  first_.reserve(tuning::kFreeContactRows + first_.rowsInUse() / tuning::kFreeContactDivisor, most, wide);
  second_.reserve(second_.rowsInUse() > 0 ? tuning::kFreeContactRows : 1, most, wide);
}

void ContactPool::store(std::int32_t contact, const PairOfBlocks& pair, const Manifold& manifold) {
  First& page = first_.page(contact);
  const std::size_t slot = Pool::slot(contact);
  StoredShape& stored = page.shape[slot];
  stored.count = static_cast<std::int8_t>(manifold.count);
  stored.incidentFace = manifold.incidentFace;
  stored.referenceFace = manifold.referenceFace;
  stored.upperIsB = manifold.upper != pair.a;
  stored.kind = manifold.kind;
  page.place[slot] = manifold.place[0];
  page.points[slot] = manifold.points[0];
  if (rowsFor(manifold.count) < 2) return;
  if (stored.secondRow < 0) stored.secondRow = second_.take();
  Second& more = second_.page(stored.secondRow);
  const std::size_t moreSlot = Pool::slot(stored.secondRow);
  more.place[moreSlot] = manifold.place[1];
  more.points[moreSlot] = manifold.points[1];
}

void ContactPool::savePoints(std::int32_t contact) {
  First& page = first_.page(contact);
  const std::size_t slot = Pool::slot(contact);
  page.start->before[slot] = page.points[slot];
  if (rowsFor(page.shape[slot].count) < 2) return;
  Second& more = second_.page(page.shape[slot].secondRow);
  const std::size_t moreSlot = Pool::slot(page.shape[slot].secondRow);
  more.start->before[moreSlot] = more.points[moreSlot];
}

void ContactPool::restorePoints(std::int32_t contact) {
  First& page = first_.page(contact);
  const std::size_t slot = Pool::slot(contact);
  page.points[slot] = page.start->before[slot];
  if (rowsFor(page.shape[slot].count) < 2) return;
  Second& more = second_.page(page.shape[slot].secondRow);
  const std::size_t moreSlot = Pool::slot(page.shape[slot].secondRow);
  more.points[moreSlot] = more.start->before[moreSlot];
}

void ContactPool::saveShape(std::int32_t contact) {
  First& page = first_.page(contact);
  const std::size_t slot = Pool::slot(contact);
  page.start->shapeBefore[slot] = page.shape[slot];
  page.start->placeBefore[slot] = page.place[slot];
  page.start->poseBefore[slot] = page.pose[slot];
  if (rowsFor(page.shape[slot].count) < 2) return;
  Second& more = second_.page(page.shape[slot].secondRow);
  const std::size_t moreSlot = Pool::slot(page.shape[slot].secondRow);
  more.start->placeBefore[moreSlot] = more.place[moreSlot];
}

void ContactPool::restoreShape(std::int32_t contact) {
  First& page = first_.page(contact);
  const std::size_t slot = Pool::slot(contact);
  const std::int32_t second = page.shape[slot].secondRow;  // it may have got one since, which it keeps
  page.shape[slot] = page.start->shapeBefore[slot];
  page.shape[slot].secondRow = second;
  page.place[slot] = page.start->placeBefore[slot];
  page.pose[slot] = page.start->poseBefore[slot];
  if (rowsFor(page.shape[slot].count) < 2) return;
  Second& more = second_.page(second);
  const std::size_t moreSlot = Pool::slot(second);
  more.place[moreSlot] = more.start->placeBefore[moreSlot];
}

void ContactPool::poisonStartRows() {
  const auto poison = [](auto& page) {
    if (page.start != nullptr) std::memset(static_cast<void*>(page.start.get()), 0xFF, sizeof *page.start);
  };
  first_.forEachPage(poison);
  second_.forEachPage(poison);
}

std::size_t ContactPool::bytes() const {
  return kFirstBytes * first_.rowsInUse() + kSecondBytes * second_.rowsInUse();
}

std::size_t ContactPool::stepBytes() const {
  return (kFirstStepBytes + (wide_ ? kWideBytes : 0)) * first_.rowsInUse() + kSecondStepBytes * second_.rowsInUse();
}

}  // namespace springtower
