# The command etendue:
#
#     docker build -t etendue .
#     docker run --rm -u "$(id -u):$(id -g)" -v "$PWD:/work" etendue run scenes/fig9b.ron
FROM rust:1.95.0-slim-bookworm AS build
WORKDIR /etendue
COPY . .
RUN cargo install --locked --path crates/cli --root /out

FROM debian:bookworm-slim
COPY --from=build /out/bin/etendue /usr/local/bin/etendue
COPY LICENSE-APACHE LICENSE-MIT /usr/share/doc/etendue/
USER 65534:65534
WORKDIR /work
ENTRYPOINT ["etendue"]
CMD ["--help"]
