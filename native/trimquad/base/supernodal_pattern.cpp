#include <algorithm>
#include <numeric>

#include "trimquad/base/elimination_tree.h"
#include "trimquad/base/error.h"
#include "trimquad/base/fill_reducing_order.h"
#include "trimquad/base/supernodal_cholesky.h"

namespace trimquad {
namespace {

/// Vertices of the graph that are eliminated together.
struct Group {
  std::vector<int> places;  // in the elimination tree, ascending
  int columns = 0;
  int rows = 0;            // of the block, with the columns
  std::int64_t zeros = 0;  // of the block's lower trapezium, which the factor does not need
  int parent = 0;
};

std::int64_t trapezium(std::int64_t columns, std::int64_t rows) {
  return columns * rows - columns * (columns - 1) / 2;
}

/// Chains of the tree whose columns have the same rows. Children come before parents.
std::vector<Group> fundamentalSupernodes(const SparsityGraph& graph, const EliminationTree& tree) {
  std::vector<Group> groups;
  std::vector<int> groupOf(tree.size() + 1);
  for (int j = 0; j < tree.size(); ++j) {
    const int weight = graph.weight[tree.order[j]];
    const bool continues = j > 0 && tree.parent[j - 1] == j &&
                           tree.count[j - 1] == tree.count[j] + graph.weight[tree.order[j - 1]];
    if (!continues) groups.emplace_back().rows = tree.count[j];
    groupOf[j] = int(groups.size()) - 1;
    groups.back().places.push_back(j);
    groups.back().columns += weight;
  }
  groupOf[tree.size()] = int(groups.size());
  for (Group& group : groups) group.parent = groupOf[tree.parent[group.places.back()]];
  return groups;
}

/// Whether a block of so many columns and numbers may hold so many superfluous zeros: dense kernels gain more
/// on larger blocks than the zeros cost. (after Ashcraft, Grimes 1989)
bool mayHold(int columns, std::int64_t numbers, std::int64_t zeros) {
  const double share = double(zeros) / double(numbers);
  return columns <= 8 || (columns <= 24 && share < 0.4) || (columns <= 64 && share < 0.15) || share < 0.05;
}

/// Merges supernodes with their parents as long as that costs few zeros.
std::vector<Group> amalgamated(std::vector<Group> groups) {
  const int n = int(groups.size());
  std::vector<std::vector<int>> children(n + 1);
  for (int s = 0; s < n; ++s) children[groups[s].parent].push_back(s);
  std::vector<char> merged(n, 0);
  for (int s = 0; s < n; ++s) {
    auto& mine = children[s];
    // Those that share most rows first.
    std::stable_sort(mine.begin(), mine.end(), [&](int a, int b) {
      return groups[a].rows - groups[a].columns > groups[b].rows - groups[b].columns;
    });
    std::vector<int> kept, places;
    for (const int c : mine) {
      Group &parent = groups[s], &child = groups[c];
      const int columns = parent.columns + child.columns, rows = parent.rows + child.columns;
      const std::int64_t numbers = trapezium(columns, rows);
      const std::int64_t zeros = parent.zeros + child.zeros + numbers -
                                 trapezium(parent.columns, parent.rows) -
                                 trapezium(child.columns, child.rows);
      if (!mayHold(columns, numbers, zeros)) {
        kept.push_back(c);
        continue;
      }
      merged[c] = 1;
      places.insert(places.end(), child.places.begin(), child.places.end());
      parent.columns = columns;
      parent.rows = rows;
      parent.zeros = zeros;
      kept.insert(kept.end(), children[c].begin(), children[c].end());
    }
    places.insert(places.end(), groups[s].places.begin(), groups[s].places.end());
    std::sort(places.begin(), places.end());
    groups[s].places = std::move(places);
    mine = std::move(kept);
  }
  std::vector<int> number(n + 1, 0);
  std::vector<Group> result;
  for (int s = 0; s < n; ++s) number[s + 1] = number[s] + !merged[s];
  number[n] = number.back();
  for (int s = 0; s < n; ++s)
    for (const int c : children[s]) groups[c].parent = s;
  for (int s = 0; s < n; ++s)
    if (!merged[s]) {
      groups[s].parent = number[groups[s].parent];
      result.push_back(std::move(groups[s]));
    }
  return result;
}

}  // namespace

SupernodalPattern::SupernodalPattern(const Eigen::SparseMatrix<double>& matrix) : size(int(matrix.cols())) {
  const ColumnClasses classes = columnClasses(matrix);
  const SparsityGraph& graph = classes.graph;
  const EliminationTree tree = eliminationTree(graph, fillReducingOrder(graph));
  std::vector<Group> groups = amalgamated(fundamentalSupernodes(graph, tree));

  // Number the groups, and the vertices along them, by a postorder of what amalgamation made of the tree.
  const int n = int(groups.size());
  {
    std::vector<int> parent(n), rank(n + 1, n);
    for (int s = 0; s < n; ++s) parent[s] = groups[s].parent;
    const auto post = postorder(parent);
    for (int k = 0; k < n; ++k) rank[post[k]] = k;
    std::vector<Group> sorted(n);
    for (int s = 0; s < n; ++s) {
      groups[s].parent = rank[groups[s].parent];
      sorted[rank[s]] = std::move(groups[s]);
    }
    groups = std::move(sorted);
  }
  std::vector<int> vertices, place(graph.size());  // place: of a vertex in the new order
  std::vector<int> firstVertex(n + 1, 0), columnAt{0};
  for (int s = 0; s < n; ++s) {
    for (const int j : groups[s].places) {
      place[tree.order[j]] = int(vertices.size());
      vertices.push_back(tree.order[j]);
      columnAt.push_back(columnAt.back() + graph.weight[vertices.back()]);
    }
    firstVertex[s + 1] = int(vertices.size());
  }

  // Rows below, first by vertices: those of the matrix and those of the children.
  std::vector<std::vector<int>> below(n);
  std::vector<int> seenFrom(graph.size(), n);
  std::vector<std::vector<int>> children(n + 1);
  for (int s = 0; s < n; ++s) children[groups[s].parent].push_back(s);
  for (int s = 0; s < n; ++s) {
    const auto add = [&](int k) {
      if (k < firstVertex[s + 1] || seenFrom[k] == s) return;
      seenFrom[k] = s;
      below[s].push_back(k);
    };
    for (int k = firstVertex[s]; k < firstVertex[s + 1]; ++k)
      for (const int u : graph.neighbours(vertices[k])) add(place[u]);
    for (const int c : children[s])
      for (const int k : below[c]) add(k);
    std::sort(below[s].begin(), below[s].end());
  }

  // The same by columns.
  std::vector<int> rowInBlock(size);
  supernodes.resize(n);
  for (int s = 0; s < n; ++s) {
    Supernode& node = supernodes[s];
    node.firstColumn = columnAt[firstVertex[s]];
    node.columns = columnAt[firstVertex[s + 1]] - node.firstColumn;
    node.parent = groups[s].parent;
    node.firstRow = int(row.size());
    for (const int k : below[s])
      for (int i = columnAt[k]; i < columnAt[k + 1]; ++i) row.push_back(i);
    node.rows = node.columns + int(row.size()) - node.firstRow;
    node.values = numbers;
    numbers += std::int64_t(node.columns) * node.rows;
    multiplications += 0.5 * node.columns * double(node.rows) * double(node.rows);
    TRIMQUAD_ASSERT(node.rows == groups[s].rows);
  }
  rowInParent.resize(row.size());
  for (int s = 0; s < n; ++s) {
    const Supernode& node = supernodes[s];
    for (int i = 0; i < node.columns; ++i) rowInBlock[node.firstColumn + i] = i;
    for (int i = 0; i < node.below(); ++i) rowInBlock[row[node.firstRow + i]] = node.columns + i;
    for (const int c : children[s]) {
      const Supernode& child = supernodes[c];
      for (int i = child.firstRow; i < child.firstRow + child.below(); ++i)
        rowInParent[i] = rowInBlock[row[i]];
    }
  }

  // The places of columns and of matrix entries.
  std::vector<int> next(columnAt.begin(), columnAt.end() - 1), column(size);
  order.resize(size);
  for (int j = 0; j < size; ++j) {
    column[j] = next[place[classes.vertexOf[j]]]++;
    order[column[j]] = j;
  }
  std::vector<int> supernodeOf(size), entries(n + 1, 0);
  for (int s = 0; s < n; ++s)
    std::fill_n(supernodeOf.begin() + supernodes[s].firstColumn, supernodes[s].columns, s);
  const auto lower =
      [&](const auto& visit) {  // every entry of the lower triangle, by its place in the factor
        for (int j = 0; j < size; ++j)
          for (int p = matrix.outerIndexPtr()[j]; p < matrix.outerIndexPtr()[j + 1]; ++p) {
            const int i = matrix.innerIndexPtr()[p];
            if (i >= j) visit(p, std::max(column[i], column[j]), std::min(column[i], column[j]));
          }
      };
  lower([&](int, int, int j) { ++entries[supernodeOf[j] + 1]; });
  for (int s = 0; s < n; ++s) {
    entries[s + 1] += entries[s];
    supernodes[s].firstEntry = entries[s];
  }
  entry.resize(entries[n]);
  lower([&](int p, int i, int j) {
    const int s = supernodeOf[j];
    const Supernode& node = supernodes[s];
    int inBlock = i - node.firstColumn;
    if (inBlock >= node.columns) {
      const auto rows = row.begin() + node.firstRow;
      inBlock = node.columns + int(std::lower_bound(rows, rows + node.below(), i) - rows);
    }
    entry[entries[s]++] = {p, node.values + std::int64_t(j - node.firstColumn) * node.rows + inBlock};
  });

  // Update matrices wait on a stack until their parent takes them.
  std::int64_t height = 0;
  for (int s = 0; s < n; ++s) {
    const std::int64_t mine = std::int64_t(supernodes[s].below()) * supernodes[s].below();
    stack = std::max(stack, height + mine);
    for (const int c : children[s]) height -= std::int64_t(supernodes[c].below()) * supernodes[c].below();
    height += mine;
  }
}

}  // namespace trimquad
