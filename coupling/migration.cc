#include "coupling/migration.h"

namespace coupling
{
  std::uint64_t migrate(std::span<const Move> moves, std::span<const PointId> points, const Travel &travel,
                        MPI_Comm communicator)
  {
    const unsigned int here = dealii::Utilities::MPI::this_mpi_process(communicator);
    constexpr int tag = 73;
    std::vector<std::vector<std::byte>> parcels; // alive until they have been sent
    std::vector<MPI_Request> requests;
    std::uint64_t n_bytes = 0;
    parcels.reserve(moves.size());
    for (const Move &move : moves)
      if (move.from == here)
        {
          const std::vector<std::byte> &parcel = parcels.emplace_back(travel.pack(points[move.rev]));
          n_bytes += parcel.size();
          MPI_Isend(parcel.data(), static_cast<int>(parcel.size()), MPI_BYTE, static_cast<int>(move.to), tag,
                    communicator, &requests.emplace_back());
        }
    for (const Move &move : moves) // messages between two ranks arrive in the order of the moves
      if (move.to == here)
        {
          MPI_Status status;
          MPI_Probe(static_cast<int>(move.from), tag, communicator, &status);
          int size = 0;
          MPI_Get_count(&status, MPI_BYTE, &size);
          std::vector<std::byte> parcel(static_cast<std::size_t>(size));
          MPI_Recv(parcel.data(), size, MPI_BYTE, static_cast<int>(move.from), tag, communicator, MPI_STATUS_IGNORE);
          travel.unpack(points[move.rev], parcel);
        }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    return dealii::Utilities::MPI::sum(n_bytes, communicator);
  }
} // namespace coupling
