# docker build -t tombolo . && docker run --rm -v "$PWD:/work" tombolo FILE.prm
FROM debian:12 AS build
COPY . /tombolo
RUN /tombolo/scripts/package --directory /package

FROM debian:12
COPY --from=build /package/*.deb /
RUN apt-get update && apt-get install -y /tombolo_*.deb && rm -rf /tombolo_*.deb /var/lib/apt/lists/*
# Open MPI refuses root, which is the user of a container.
ENV OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1
WORKDIR /work
ENTRYPOINT ["tombolo"]
