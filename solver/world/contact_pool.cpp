#include "solver/world/contact_pool.h"

#include "core/tuning.h"

#include <algorithm>
#include <cstring>

namespace springtower {

namespace {

// Rows in pages for which `has(page)`, but not more than are in use.
template <class Page, class Has>
std::size_t rowsWith(const PagePool<Page>& pool, const Has& has) {
  std::size_t rows = 0;
  pool.forEachPage([&](const Page& page) { rows += has(page) ? kPageRows : 0; });
  return std::min(rows, pool.rowsInUse());
}

}  // namespace

std::int32_t ContactPool::take() {
  const std::int32_t contact = first_.take();
  First& page = first_.page(contact);
  page.shape[Pool::slot(contact)] = StoredShape{};
  page.sleepLoad.write(Pool::slot(contact), SleepLoad{});
  page.pose.write(Pool::slot(contact), RelativePose{});
  return contact;
}

void ContactPool::giveBack(std::int32_t contact) {
  const std::int32_t second = shape(contact).secondRow;
  if (second >= 0) second_.giveBack(second);
  first_.giveBack(contact);
}

void ContactPool::reserve(std::size_t most, bool wide) {
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
  page.pose.write(slot, RelativePose{});  // that of the manifold before
  if (rowsFor(manifold.count) < 2) return;
  if (stored.secondRow < 0) stored.secondRow = second_.take();
  Second& more = second_.page(stored.secondRow);
  const std::size_t moreSlot = Pool::slot(stored.secondRow);
  more.place[moreSlot] = manifold.place[1];
  more.points[moreSlot] = manifold.points[1];
}

// Calls `visit(page, slot)` with the page of a contact's first row and, if a second row is in use, with the page of that.
template <class Visit>
void ContactPool::forRows(std::int32_t contact, const Visit& visit) {
  First& page = first_.page(contact);
  const std::size_t slot = Pool::slot(contact);
  visit(page, slot);
  const StoredShape& stored = page.shape[slot];
  if (rowsFor(stored.count) == kManifoldRows) visit(second_.page(stored.secondRow), Pool::slot(stored.secondRow));
}

void ContactPool::savePoints(std::int32_t contact) {
  forRows(contact, [](auto& page, std::size_t slot) { (*page.start).before[slot] = page.points[slot]; });
}

void ContactPool::saveTrial(std::int32_t contact) {
  forRows(contact, [](auto& page, std::size_t slot) { (*page.start).before[slot] = page.trial[slot]; });
}

void ContactPool::restorePoints(std::int32_t contact) {
  forRows(contact, [](auto& page, std::size_t slot) { page.points[slot] = (*page.start).before[slot]; });
}

void ContactPool::copyToTrial(std::int32_t contact) {
  forRows(contact, [](auto& page, std::size_t slot) { page.trial[slot] = page.points[slot]; });
}

void ContactPool::copyFromTrial(std::int32_t contact) {
  forRows(contact, [](auto& page, std::size_t slot) { page.points[slot] = page.trial[slot]; });
}

void ContactPool::saveShape(std::int32_t contact) {
  First& first = first_.page(contact);
  const std::size_t at = Pool::slot(contact);
  FirstStart& start = *first.start;
  start.shapeBefore[at] = first.shape[at];
  start.poseBefore[at] = first.pose.read(at);
  forRows(contact, [](auto& page, std::size_t slot) { (*page.start).placeBefore[slot] = page.place[slot]; });
}

void ContactPool::restoreShape(std::int32_t contact) {
  First& first = first_.page(contact);
  const std::size_t at = Pool::slot(contact);
  const std::int32_t second = first.shape[at].secondRow;  // a second row taken since is kept
  const FirstStart& start = *first.start;
  first.shape[at] = start.shapeBefore[at];
  first.shape[at].secondRow = second;
  first.pose.write(at, start.poseBefore[at]);
  forRows(contact, [](auto& page, std::size_t slot) { page.place[slot] = (*page.start).placeBefore[slot]; });
}

void ContactPool::releaseSaved() {
  const auto release = [](auto& page) { page.start.release(); };
  first_.forEachPage(release);
  second_.forEachPage(release);
}

void ContactPool::poisonStartRows() {
  const auto poison = [](auto& page) {
    if (auto* start = page.start.get()) std::memset(static_cast<void*>(start), 0xFF, sizeof *start);
  };
  first_.forEachPage(poison);
  second_.forEachPage(poison);
}

std::size_t ContactPool::bytes() const {
  return kFirstBytes * first_.rowsInUse() + kSecondBytes * second_.rowsInUse() +
         kSleepBytes * rowsWith(first_, [](const First& page) { return page.sleepLoad.isMade(); });
}

std::size_t ContactPool::stepBytes() const {
  const auto copies = [](const auto& page) { return page.start.get() != nullptr; };
  return (kFirstStepBytes + (first_.isWide() ? kWideBytes : 0)) * first_.rowsInUse() + kSecondStepBytes * second_.rowsInUse() +
         kPoseBytes * rowsWith(first_, [](const First& page) { return page.pose.isMade(); }) +
         sizeof(FirstStart) / kPageRows * rowsWith(first_, copies) + sizeof(SecondStart) / kPageRows * rowsWith(second_, copies);
}

}  // namespace springtower
